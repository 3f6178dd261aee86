"""Shaft twist and health of buses: computed where they are limited, recorded, watched."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hil.core.errors import BadInputError, BenchError
from hil.core.model import load_model
from hil.core.recording import read_recording
from hil.engine import BenchFile, RunRequest, run_plan
from hil.engine.bench import open_bench
from hil.engine.limit_tables import NamedLimit, TwistTable
from tests.benches_for_tests import SIM, plan, sim_bench

STEP = (
    "[{step: {segment: s, quantity: motor_torque, from_nm: 0, to_nm: 30, before_s: 0.3, after_s: 0.5, "
    "load: speed}}]"
)
MODEL = load_model(SIM.simulation.model)
RATIO = MODEL.parameters["gear_ratio"]


def bench(name: str, twist: TwistTable | None = None, **watch: NamedLimit) -> BenchFile:
    return sim_bench(name, limits=SIM.limits.model_copy(update={"watch": watch, "twist": twist}))


def limit(channel: str, unit: str, above: float, **keys: object) -> NamedLimit:
    return NamedLimit.model_validate({"channel": channel, "unit": unit, "above": above, **keys})


def test_twist_follows_torque_over_stiffness(tmp_path: Path) -> None:
    named = limit("shaft_twist_rad", "rad", 0.5)
    file = bench("twist", TwistTable(gear_ratio=RATIO, forget_s=60.0), t=named)
    outcome = run_plan(RunRequest(plan(STEP), file, tmp_path))
    assert outcome.error is None
    recording, segment = read_recording(outcome.recording, allow_missing=True), outcome.result.segments[0]
    inside = recording.between(segment.step_s, segment.end_s)
    before = recording.between(segment.start_s, segment.step_s)["shaft_twist_rad"]
    stiffness = MODEL.parameters["shaft_stiffness"]
    twist = inside["shaft_twist_rad"] - np.nanmean(before)
    expected = inside["shaft_torque_nm"] / stiffness
    assert np.nanmax(twist) == pytest.approx(np.max(expected), rel=0.1)


def test_twist_beyond_its_limit_trips(tmp_path: Path) -> None:
    named = limit("shaft_twist_rad", "rad", 0.02)
    file = bench("twisted", TwistTable(gear_ratio=RATIO), t=named)
    outcome = run_plan(RunRequest(plan(STEP), file, tmp_path))
    assert isinstance(outcome.error, BenchError)
    assert outcome.error.what.startswith("limit tripped: shaft_twist_rad reached 0.0")


def test_the_load_of_a_bus_is_limited_and_recorded(tmp_path: Path) -> None:
    file = bench("load", load=limit("bus_load_dyno", "1", 0.1, persistence_samples=2, response="warn"))
    outcome = run_plan(RunRequest(plan(STEP), file, tmp_path))
    assert outcome.error is None
    (result,) = [found for found in outcome.result.limits if found.name == "load"]
    assert result.reached == 1
    load = read_recording(outcome.recording, allow_missing=True)["bus_load_dyno"]
    assert 0.3 < np.nanmax(load) < 1.0
    assert result.highest == pytest.approx(np.nanmax(load), rel=0.05)


@pytest.mark.parametrize(
    ("named", "said"),
    [
        (limit("motor_speed_rad_s", "rpm", 9.0), r"motor_speed_rad_s is in rad/s"),
        (limit("motor_speed_rad_s", "rad/s", 9.0, of="slope"), r"motor_speed_rad_s is in rad/s2"),
        (limit("oil_temperature_k", "K", 9.0), r"limits.watch.t: no device gives this channel"),
        (limit("shaft_twist_rad", "rad", 9.0), r"no device gives this channel"),
        (limit("bus_load_nowhere", "1", 9.0), r"no device gives this channel"),
    ],
)
def test_a_limit_of_nothing_or_in_another_unit_is_refused(named: NamedLimit, said: str) -> None:
    with pytest.raises(BadInputError, match=said), open_bench(bench("wrong", t=named)):
        pass


def test_a_magnitude_that_nobody_measures_is_no_limit_and_refused() -> None:
    from hil.engine.bench_channels import refuse_channels

    with open_bench(sim_bench("unwatched")) as opened:
        streams = [s for s in opened.streams if "shaft_torque_right_nm" not in s.channels]
        with pytest.raises(BadInputError, match="limits.wheel_speed_rad_s: nothing is watched by it"):
            refuse_channels(opened.file, streams, {})
