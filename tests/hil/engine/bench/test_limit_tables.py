"""What a bench file may say of limits and interlocks, and what of it is refused with its key."""

from __future__ import annotations

import tomllib
from typing import Any

import pytest
from pydantic import BaseModel, ValidationError

from hil.core.errors import BadInputError
from hil.engine import BenchFile
from hil.engine.bench.bench_file import bench_from_dict
from hil.engine.bench.ranges import Interlock, Limits, NamedLimit, Range, TwistTable, ranges_of
from tests.benches_for_tests import SIM

WARM = """
[limits.watch.warm]
channel = "motor_speed_rad_s"
unit = "rad/s"
above = 90.0
hysteresis = 2.0
persistence_samples = 5
response = "pause"
"""
STEEP = WARM.replace('above = 90.0', 'of = "slope"\nover_s = 0.02\nabove = 90.0')  # fmt: skip
CAGE = """
[interlocks.cage]
channel = "motor_speed_rad_s"
unit = "rad/s"
below = -0.5
message = "shut the cage"
"""


def loaded(further: str) -> BenchFile:
    text = f"{SIM.text}\n{further}"
    return bench_from_dict(tomllib.loads(text), text, SIM.source)


def test_a_file_of_before_means_what_it_meant() -> None:
    ranges = ranges_of(loaded("").limits)
    assert {r.response for r in ranges} == {"trip"}
    assert {r.hysteresis for r in ranges} == {0.0}
    assert {r.samples(0.001) for r in ranges} == {5}


def test_the_magnitudes_are_those_of_both_directions_and_a_side_bears_half() -> None:
    limits = loaded("").limits
    ends = {r.channel: (r.below, r.above) for r in ranges_of(limits)}
    torque, shafts = limits.motor_torque_nm, limits.shaft_torque_nm
    assert ends == {
        "motor_torque_ref_nm": (-torque, torque),
        "motor_torque_nm": (-torque, torque),
        "motor_speed_rad_s": (-limits.motor_speed_rad_s, limits.motor_speed_rad_s),
        "wheel_speed_left_rad_s": (-limits.wheel_speed_rad_s, limits.wheel_speed_rad_s),
        "wheel_speed_right_rad_s": (-limits.wheel_speed_rad_s, limits.wheel_speed_rad_s),
        "wheel_speed_rad_s": (-limits.wheel_speed_rad_s, limits.wheel_speed_rad_s),
        "shaft_torque_left_nm": (-shafts / 2, shafts / 2),
        "shaft_torque_right_nm": (-shafts / 2, shafts / 2),
        "shaft_torque_nm": (-shafts, shafts),
        "vehicle_speed_m_s": (-limits.vehicle_speed_m_s, limits.vehicle_speed_m_s),
    }


@pytest.mark.parametrize(("persistence_s", "samples"), [(0.0, 1), (0.004, 1), (0.02, 2), (0.05, 5)])
def test_a_time_is_at_least_one_sample_long(persistence_s: float, samples: int) -> None:
    assert Range("c", 0.0, 1.0, persistence_s).samples(0.01) == samples


def test_what_is_stated_is_what_is_watched() -> None:
    file = loaded(WARM + CAGE)
    ranges = {r.name: r for r in ranges_of(file.limits, file.interlocks)}
    warm, cage = ranges["warm"], ranges["cage"]
    assert (warm.above, warm.hysteresis, warm.samples(0.001), warm.response) == (90.0, 2.0, 5, "pause")
    assert (cage.below, cage.response, cage.well_for_s, cage.timeout_s) == (-0.5, "hold", 1.0, 60.0)
    assert (cage.message, cage.samples(0.001)) == ("shut the cage", 5)
    assert ranges_of(loaded(STEEP).limits)[-1].slope_s == 0.02


@pytest.mark.parametrize(
    "key",
    ["motor_torque_nm", "driving_torque_nm", "shaft_torque_nm", "motor_speed_rad_s", "wheel_speed_rad_s",
     "vehicle_speed_m_s"],
)  # fmt: skip
def test_a_magnitude_that_is_missing_is_an_error_and_never_no_limit(key: str) -> None:
    text = "\n".join(line for line in SIM.text.splitlines() if not line.startswith(f"{key} ="))
    if key in ("motor_speed_rad_s", "wheel_speed_rad_s", "shaft_torque_nm"):  # also a sensor's noise
        text += f"\n{key} = 0.0\n"  # the noise table is the last
    with pytest.raises(BadInputError, match=f"limits.{key}: is missing"):
        bench_from_dict(tomllib.loads(text), text, SIM.source)


@pytest.mark.parametrize(
    ("table", "change", "said"),
    [
        (WARM, ("above = 90.0", ""), "sets no limit; give 'below', 'above' or both"),
        (WARM, ("above = 90.0", "above = 90.0\nbelow = 88.0"), "the hysteresis leaves no range"),
        (WARM, ("above = 90.0", "above = 90.0\npersistence_s = 0.1"), "not both"),
        (WARM, ("above = 90.0", "above = 90.0\nover_s = 0.1"), "over_s goes with of = 'slope'"),
        (WARM, ('"pause"', '"hope"'), "limits.watch.warm.response"),
        (WARM, ('unit = "rad/s"', ""), "limits.watch.warm.unit: is missing"),
        (WARM, ("above = 90.0", "above = nan"), "limits.watch.warm.above"),
        (WARM, ("above = 90.0", "above = 1e308"), "limits.watch.warm.above"),
        (
            WARM,
            ("persistence_samples = 5", "persistence_samples = -1"),
            "limits.watch.warm.persistence_samples",
        ),
        (CAGE, ('message = "shut the cage"', ""), "interlocks.cage.message: is missing"),
        (CAGE, ("below = -0.5", 'below = -0.5\nresponse = "trip"'), "interlocks.cage.response"),
        (CAGE, ("below = -0.5", "below = -0.5\ntimeout_s = 0"), "interlocks.cage.timeout_s"),
        ("[limits.twist]\ngear_ratio = 0.0\n", ("", ""), "limits.twist.gear_ratio"),
    ],
)
def test_what_makes_no_sense_is_refused_with_its_key(table: str, change: tuple[str, str], said: str) -> None:
    with pytest.raises(BadInputError) as caught:
        loaded(table.replace(*change) if change[0] else table)
    assert said in str(caught.value)


LIMITS = SIM.limits.model_dump(include={*SIM.limits.model_fields_set} - {"channels", "watch", "twist"})
NAMED = {"channel": "c", "unit": "K", "above": 1e5}
LOCK = {**NAMED, "message": "m"}
SLOPE = {**NAMED, "of": "slope"}
TWIST = {"gear_ratio": 9.0}
SMALLEST, LARGEST = 5e-324, 1e6


@pytest.mark.parametrize(
    ("table", "given", "key", "least", "below", "most", "above"),
    [
        (Limits, LIMITS, "motor_torque_nm", SMALLEST, 0.0, LARGEST, 1e6 + 0.5),
        (Limits, LIMITS, "vehicle_speed_m_s", SMALLEST, 0.0, LARGEST, 1e6 + 0.5),
        (Limits, LIMITS, "persistence_s", 0.0, -SMALLEST, 10.0, 10.1),
        (NamedLimit, {**NAMED, "below": -1e6}, "above", -1e6 + 1, -1e6 - 1, LARGEST, 1e6 + 0.5),
        (NamedLimit, NAMED, "below", -1e6, -1e6 - 0.5, 1e5 - 1, 1e6),
        (NamedLimit, NAMED, "hysteresis", 0.0, -SMALLEST, LARGEST, 1e6 + 0.5),
        (NamedLimit, NAMED, "persistence_s", 0.0, -SMALLEST, 10.0, 10.1),
        (NamedLimit, NAMED, "persistence_samples", 0, -1, 100_000, 100_001),
        (NamedLimit, SLOPE, "over_s", 0.001, 0.0009, 1.0, 1.01),
        (NamedLimit, NAMED, "channel", "x", "", "x" * 60, None),
        (NamedLimit, NAMED, "unit", "x", "", "x" * 20, "x" * 21),
        (Interlock, LOCK, "unit", "x", "", "x" * 20, "x" * 21),
        (Interlock, LOCK, "channel", "x", "", "x" * 60, None),
        (Interlock, LOCK, "message", "x", "", "x" * 200, "x" * 201),
        (Interlock, LOCK, "well_for_s", 0.0, -SMALLEST, 60.0, 60.1),
        (Interlock, LOCK, "timeout_s", SMALLEST, 0.0, 3600.0, 3600.1),
        (TwistTable, TWIST, "gear_ratio", SMALLEST, 0.0, 100.0, 100.1),
        (TwistTable, TWIST, "forget_s", 0.05, 0.04, 60.0, 60.1),
    ],
)
def test_each_number_has_bounds_that_are_allowed_themselves(
    table: type[BaseModel], given: dict[str, Any], key: str, least: Any, below: Any, most: Any, above: Any
) -> None:
    for allowed in (least, most):
        assert getattr(table.model_validate({**given, key: allowed}), key) == allowed
    for refused in (below, above):
        with pytest.raises(ValidationError, match=key):
            table.model_validate({**given, key: refused})
