"""A run on a bench with a panel: vehicle and road are set, confirmed, recorded, and act."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest

from hil.core.errors import BadInputError
from hil.core.recording import VEHICLE, read_recording
from hil.engine import RunRequest, run_plan
from hil.engine.bench.bench_file import bench_from_dict
from sim_backend.rcs import EmulatedPanel
from tests.benches_for_tests import SIM, plan, sim_bench

STEPS = """[
  {set_controller: {file: phase_stabilization.toml}},
  {set_vehicle: {mass_kg: MASS, f0_n: 100, f1_ns_m: 2, f2_ns2_m2: 0.4, slip_percent: 1}},
  {step: {segment: s, quantity: driving_torque, from_nm: 0, to_nm: 200, before_s: 0.1, after_s: 1}}]"""


def with_panel(name: str, **keys):
    data = tomllib.loads(SIM.text)
    data["name"] = name
    for key, bus in data["buses"].items():
        bus["channel"] = f"{name}/{key}"
    data["devices"] = {"panel": {"kind": "rcs-panel", "port": "/dev/ttyUSB0", **keys}}
    return bench_from_dict(data, SIM.text, SIM.source)


def run(folder: Path, mass_kg: int):
    steps = STEPS.replace("MASS", str(mass_kg))
    return run_plan(RunRequest(plan(steps), with_panel(f"panel-{mass_kg}"), folder))


def test_what_the_panel_confirmed_is_recorded_and_acts(tmp_path: Path) -> None:
    speeds = {}
    for mass_kg in (1000, 4000):
        outcome = run(tmp_path / str(mass_kg), mass_kg)
        assert outcome.error is None, outcome.error
        recording = read_recording(outcome.recording)
        assert recording.metadata[VEHICLE] == {
            "vehicle mass": f"{mass_kg} kg",
            "road load f0": "100 N",
            "road load f1": "2 N s/m",
            "road load f2": "0.4 N s²/m²",
            "slip": "1 %",
        }
        (event,) = [event.text for event in recording.events if event.kind == "vehicle"]
        assert event.startswith(f"panel confirms: vehicle mass {mass_kg} kg, road load f0 100 N")
        speeds[mass_kg] = float(np.max(recording["vehicle_speed_m_s"]))
    assert speeds[1000] > 2 * speeds[4000]


def test_a_bench_without_a_panel_is_told_before_the_run(tmp_path: Path) -> None:
    with pytest.raises(BadInputError, match="no device that accepts vehicle and road load"):
        run_plan(RunRequest(plan(STEPS.replace("MASS", "1500")), sim_bench("no-panel"), tmp_path))


def failing_from(monkeypatch: pytest.MonkeyPatch, at_s: float, until_s: float, change) -> None:
    """From a time on, in seconds after the panel came up, what it hears or says is changed."""
    whole, looks = EmulatedPanel.hear, [0]

    def hear(panel: EmulatedPanel, data: bytes) -> bytes:
        looks[0] += data.count(b"ASTF")  # the second request of a beat, which may come without the first
        time_s = 0.5 * looks[0]
        return change(panel, data, whole) if at_s <= time_s < until_s else whole(panel, data)

    monkeypatch.setattr(EmulatedPanel, "hear", hear)


def silent(panel, data, whole) -> bytes:
    return b""


def garbled(panel, data, whole) -> bytes:
    return b"\xff\x03\x02 AS" + data + whole(panel, data) + b"\x02 half"


def alarmed(panel, data, whole) -> bytes:
    panel.latched = ["17"]
    return bytes(whole(panel, data))


def local(panel, data, whole) -> bytes:
    panel.remote = False
    return bytes(whole(panel, data))


@pytest.mark.parametrize(
    ("change", "until_s", "said"),
    [
        (silent, 1e9, "the panel has sent nothing for 1"),
        (silent, 2.5, ""),
        (garbled, 1e9, ""),
        (alarmed, 1e9, "alarm 17"),
        (local, 1e9, "the panel was switched to local"),
    ],
    ids=["silent", "silent for a moment", "garbage, echo and halves", "an alarm", "taken to local"],
)
def test_a_panel_that_fails_in_a_run(tmp_path, monkeypatch, change, until_s: float, said: str) -> None:
    failing_from(monkeypatch, 2.0, until_s, change)
    bench = with_panel(f"panel-{change.__name__}", gone_after_s=1.45)
    outcome = run_plan(RunRequest(plan("[{wait: {duration_s: 4}}]"), bench, tmp_path))
    assert outcome.result.safe_state == "confirmed"
    if said:
        assert outcome.error is not None
        assert said in str(outcome.error)
    else:
        assert outcome.error is None
