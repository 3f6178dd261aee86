"""Shaft twist and health of buses: computed where they are limited, recorded, watched."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest

from drivers import BusLoop, Samples, Stream, bits_on_the_wire
from hil.core.can.frames import ERROR_FRAME, FRAME
from hil.core.errors import BadInputError, BenchError
from hil.core.model import EffectUse, load_model, save_model
from hil.core.recording import read_recording
from hil.engine import BenchFile, RunRequest, run_plan
from hil.engine.bench.bench import open_bench
from hil.engine.bench.computed_channels import BusStatistics, ShaftTwist, channels_of_bus, computed_channels
from hil.engine.bench.ranges import NamedLimit, TwistTable
from test_plans import Array
from tests.benches_for_tests import SIM, plan, sim_bench
from tests.clocks import SteppedClock

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


@pytest.mark.parametrize(("largest_nm", "trips"), [(5.0, True), (200.0, False)])
def test_an_inverter_that_gives_less_than_it_is_asked_for_is_noticed(
    tmp_path: Path, largest_nm: float, trips: bool
) -> None:
    weak = dataclasses.replace(MODEL, effects=(EffectUse("torque_saturation", {"limit_nm": largest_nm}),))
    save_model(weak, tmp_path / "weak.toml")
    named = limit("motor_torque_error_nm", "N m", 10.0, below=-10.0, persistence_s=0.1)
    simulation = SIM.simulation.model_copy(update={"model": tmp_path / "weak.toml"})
    file = bench("weak", t=named).model_copy(update={"simulation": simulation})
    outcome = run_plan(RunRequest(plan(STEP), file, tmp_path / "run"))
    assert (outcome.error is not None) == trips
    if outcome.error:
        assert outcome.error.what.startswith("limit tripped: motor_torque_error_nm")
        assert outcome.result.safe_state == "confirmed"


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
        (limit("oil_temperature_k", "K", 9.0), r"limits.watch.t: no device provides this channel"),
        (limit("shaft_twist_rad", "rad", 9.0), r"no device provides this channel"),
        (limit("bus_load_nowhere", "1", 9.0), r"no device provides this channel"),
    ],
)
def test_a_limit_of_nothing_or_in_another_unit_is_refused(named: NamedLimit, said: str) -> None:
    with pytest.raises(BadInputError, match=said), open_bench(bench("wrong", t=named)):
        pass


def test_a_magnitude_that_nobody_measures_is_no_limit_and_refused() -> None:
    from hil.engine.bench.bench_channels import refuse_channels

    with open_bench(sim_bench("unwatched")) as opened:
        streams = [s for s in opened.streams if "shaft_torque_right_nm" not in s.channels]
        with pytest.raises(BadInputError, match="limits.wheel_speed_rad_s: the limit has no effect"):
            refuse_channels(opened.file, streams, {})


def speeds(motor_rad_s: Array, left_rad_s: Array, right_rad_s: Array, first: int = 0) -> list[Samples]:
    times_s = 5.0 + 0.001 * np.arange(first, first + len(motor_rad_s), dtype=np.float64)
    wheels = np.column_stack([left_rad_s, right_rad_s])
    return [Samples(MOTOR, times_s, motor_rad_s[:, None]), Samples(WHEELS, times_s, wheels)]


MOTOR = Stream("motor", "bus 'rmcu'", ("motor_speed_rad_s",), ("rad/s",), 0.001)
WHEELS = Stream(
    "wheels", "bus 'dyno'", ("wheel_speed_left_rad_s", "wheel_speed_right_rad_s"), ("rad/s",) * 2, 0.001
)
ONES = np.ones(1001)


def twisted(*pieces: list[Samples], forget_s: float = 60.0) -> Array:
    twist = ShaftTwist(TwistTable(gear_ratio=8.0, forget_s=forget_s))
    found = []
    for piece in pieces:
        for samples in piece:
            twist.take(samples)
        found += [samples.values[:, 0] for samples in twist.samples()]
    return np.concatenate(found) if found else np.zeros(0)


@pytest.mark.parametrize(
    ("motor", "left", "right", "expected"),
    [
        (8.0, 1.0, 1.0, 0.0),  # all turn together
        (8.8, 1.0, 1.0, 0.1),  # 0.1 rad/s for 1 s
        (8.0, 1.2, 1.0, -0.1),  # the mean of both wheels counts
        (-8.8, -1.0, -1.0, -0.1),
    ],
)
def test_twist_is_the_integral_of_what_the_wheels_lag(
    motor: float, left: float, right: float, expected: float
) -> None:
    found = twisted(speeds(motor * ONES, left * ONES, right * ONES))
    assert found[-1] == pytest.approx(expected * 60.0 * -math.expm1(-1 / 60.0), rel=1e-3, abs=1e-9)
    assert found[0] == 0.0


def test_an_offset_reads_as_offset_times_forgetting() -> None:
    found = twisted(speeds(np.full(3001, 8.08), np.ones(3001), np.ones(3001)), forget_s=0.2)
    assert found[-1] == pytest.approx(0.01 * 0.2, rel=1e-3)


def test_it_waits_for_the_slowest_of_the_three_and_gives_each_sample_once() -> None:
    motor, wheels = speeds(8.8 * ONES, ONES, ONES)
    first = Samples(WHEELS, wheels.time_s[:500], wheels.values[:500])
    rest = Samples(WHEELS, wheels.time_s[500:], wheels.values[500:])
    assert len(twisted([motor])) == 0
    assert np.array_equal(twisted([motor, first], [rest]), twisted([motor, wheels]))


def test_wheels_that_come_seldom_are_taken_between_their_samples() -> None:
    times_s: Array = 0.001 * np.arange(101, dtype=np.float64)
    seldom = times_s[::50]
    wheels = Samples(WHEELS, seldom, np.column_stack([20.0 * seldom, 20.0 * seldom]))
    motor = [Samples(MOTOR, t, 160.0 * t[:, None]) for t in np.split(times_s, [1, 20, 35, 60])]
    assert np.allclose(twisted([wheels, motor[0]], *([piece] for piece in motor[1:])), 0.0, atol=1e-12)


def test_what_is_not_known_is_not_known_and_a_gap_adds_nothing() -> None:
    motor = 8.8 * ONES
    motor[500] = np.nan
    found = twisted(speeds(motor, ONES, ONES))
    assert np.isnan(found[500])
    assert found[-1] == pytest.approx(0.1, rel=0.01)
    for first in (60_000, 1_200):  # a minute later, or a fifth of a second
        apart = twisted(speeds(8.8 * ONES, ONES, ONES), speeds(8.8 * ONES, ONES, ONES, first=first))
        assert apart[-1] == pytest.approx(0.2, rel=0.02)  # and not what lies between


def test_load_and_error_frames_of_one_bus_are_counted() -> None:
    loop = BusLoop(SteppedClock(), [])
    health = BusStatistics(loop, "rmcu", 1_000_000)
    block = np.zeros(100, FRAME)
    block["length"] = 8
    block["flags"][:3] = ERROR_FRAME
    health.take_frames("rmcu", block)
    health.take_frames("dyno", block)
    assert health.samples() == []  # not for long enough
    loop.run_for(0.1)
    (given,) = health.samples()
    assert given.stream.channels == ("bus_load_rmcu", "bus_error_frames_rmcu")
    assert given.values[0, 0] == pytest.approx(bits_on_the_wire(block).sum() / 1e5)
    assert 0.1 < given.values[0, 0] < 0.14
    assert given.values[0, 1] == 3
    loop.run_for(0.1)
    (given,) = health.samples()
    assert given.values.tolist() == [[0.0, 3.0]]  # load of the last 0.1 s, errors since the beginning


@pytest.mark.parametrize(
    ("name", "channel"),
    [("rmcu", "bus_load_rmcu"), ("can-0.left", "bus_load_can_0_left"), ("bü", "bus_load_b_")],
)
def test_names_of_buses_become_names_of_channels(name: str, channel: str) -> None:
    assert channels_of_bus(name)[0] == channel


def test_only_what_is_limited_is_computed() -> None:
    loop = BusLoop(SteppedClock(), [])
    assert computed_channels(bench("none", TwistTable(gear_ratio=8.0)), loop) == []
    twist, load = (limit("shaft_twist_rad", "rad", 0.1), limit("bus_error_frames_dyno", "1", 3.0))
    found = computed_channels(bench("both", TwistTable(gear_ratio=8.0), t=twist, e=load), loop)
    assert [channel for one in found for stream in one.streams for channel in stream.channels] == [
        "shaft_twist_rad", "bus_load_dyno", "bus_error_frames_dyno",
    ]  # fmt: skip
