"""Clocks of several logs: gaps are reported, another time zone and a bus recorded twice are refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hil.core.can.frames import frames
from hil.core.can_logs import CanLog
from hil.core.errors import BadInputError
from hil.engine.replay._channels import merged
from hil.engine.replay._clocks import remarks_on_clocks

SECOND = 10**9


def log(folder: Path, name: str, channel: str, began_s: float, length_s: int = 20) -> CanLog:
    (folder / name).touch()
    block = frames(1, np.zeros(length_s, np.uint64), 8, np.arange(float(length_s)))
    return CanLog(folder / name, {channel: block}, round(began_s * SECOND))


@pytest.mark.parametrize("hours", [-2.0, 1.0, 5.5, 5.75])
def test_a_log_of_another_zone_is_refused_with_the_shift_that_mends_it(hours: float, tmp_path: Path) -> None:
    logs = [log(tmp_path, "a.log", "can0", 1e6), log(tmp_path, "b.asc", "1", 1e6 + 3 + hours * 3600)]
    with pytest.raises(BadInputError, match="another time zone") as caught:
        merged(logs)
    later, sign = ("b.asc", -1) if hours > 0 else ("a.log", 1)
    shift_s = sign * hours * 3600
    assert f"--shift {later}={shift_s:.0f}" in caught.value.fix
    found = merged(logs, {later: shift_s})
    starts = {name: block["time_s"][0] for (name, _), block in found.channels.items()}
    assert starts["b.asc"] - starts["a.log"] == pytest.approx(3.0)
    stated = merged(logs, {later: 0.0})
    assert any("without a frame" in remark for remark in stated.remarks)


def test_parts_of_one_drive_may_lie_an_hour_apart(tmp_path: Path) -> None:
    found = merged([log(tmp_path, "a.log", "can0", 1e6), log(tmp_path, "b.log", "can0", 1e6 + 3600)])
    assert remarks_on_clocks([log(tmp_path, "a.log", "can0", 1e6)], {}) == []
    assert found.remarks == ["between a.log and b.log lie 3581 s without a frame"]
    both = found.of("can0")
    assert both is not None
    assert len(both) == 40


def test_one_channel_of_two_files_at_one_time_is_refused_until_one_is_picked(tmp_path: Path) -> None:
    found = merged([log(tmp_path, "a.log", "can0", 1e6), log(tmp_path, "b.log", "can0", 1e6 + 5)])
    with pytest.raises(BadInputError, match="overlap by 14 s"):
        found.of("can0")
    one = found.of("b.log:can0")
    assert one is not None
    assert len(one) == 20


def test_a_shift_of_a_log_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BadInputError, match="there is: a.log"):
        merged([log(tmp_path, "a.log", "can0", 1e6)], {"b.log": 1.0})
