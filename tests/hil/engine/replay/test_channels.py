"""Several logs on one clock."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from hil.core.can.frames import frames
from hil.core.can_logs import CanLog
from hil.engine.replay._channels import chosen_buses, listed, merged

SECOND = 10**9


def test_logs_lie_as_their_wall_clock_says(tmp_path: Path) -> None:
    logs = []
    for name, began_s, first_s in (("late", 100, 0.5), ("early", 90, 2.0)):
        path = tmp_path / name
        path.touch()
        logs.append(
            CanLog(
                path, {"1": frames(1, np.zeros(2, np.uint64), 8, first_s + np.arange(2.0))}, began_s * SECOND
            )
        )
    found = merged(logs)
    assert found.began_ns == 92 * SECOND
    assert found.channels["early", "1"]["time_s"].tolist() == [0.0, 1.0]
    assert found.channels["late", "1"]["time_s"].tolist() == [8.5, 9.5]
    both, one = found.of("1"), found.of("late:1")
    assert both is not None
    assert one is not None
    assert (both["time_s"].tolist(), len(one)) == ([0.0, 1.0, 8.5, 9.5], 2)
    assert found.names == ["1"]


def test_six_identifiers_of_a_channel_are_shown_and_that_there_are_more(tmp_path: Path) -> None:
    for count, shown in ((6, "0x001, 0x002, 0x003, 0x004, 0x005, 0x006"), (7, "0x006, …")):
        block = frames(0, np.zeros(count, np.uint64), 8, np.arange(float(count)))
        block["id"] = np.arange(1, count + 1)
        found = merged([CanLog(tmp_path / "a.asc", {"1": block}, SECOND)])
        said = listed(found, {"rmcu": {1, 2, 99}, "dyno": {88}})
        assert said.startswith(f"channel '1' of a.asc: {count} frames, {count} standard identifiers (0x001, ")
        assert f"{shown}), 2 of bus 'rmcu'" in said


def test_a_bus_of_which_no_log_has_frames_does_not_hide_the_next(tmp_path: Path) -> None:
    block = frames(0x183, np.zeros(5, np.uint64), 8, np.arange(5.0))
    found = merged([CanLog(tmp_path / "a.asc", {"1": block}, SECOND)])
    names: dict[str, set[str]] = {"rmcu": set(), "dyno": set()}
    chosen, told, channels = chosen_buses(found, {"rmcu": {0x110}, "dyno": {0x183, 0x184}}, names, {})
    assert list(chosen) == ["dyno"]
    assert channels == {"dyno": "1"}
    assert told == [
        "no log has frames of bus 'rmcu': its channels are missing",
        "bus 'dyno' is channel '1': 5 frames, 1 of 2 known identifiers",
    ]
