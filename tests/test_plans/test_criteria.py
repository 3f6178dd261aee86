from __future__ import annotations

from typing import Any

import pytest

from hil.core.errors import BadInputError
from test_plans import Criterion
from tests.test_plans.writing import STEP, plan_of

CHIRP = {
    "segment": "sweep",
    "quantity": "motor_torque",
    "from_hz": 1,
    "to_hz": 30,
    "duration_s": 30,
    "amplitude_nm": 5,
}
MOTOR_STEP = STEP | {"segment": "motor", "quantity": "motor_torque", "to_nm": 40}
SHORT = STEP | {"segment": "short", "after_s": 10}
DOWN = STEP | {"segment": "down", "from_nm": 326, "to_nm": 0}


def criterion(**keys: Any) -> Criterion:
    steps = [{"step": STEP}, {"chirp": CHIRP}, {"step": MOTOR_STEP}, {"step": SHORT}, {"step": DOWN}]
    return plan_of(*steps, criteria=[keys]).criteria[0]


def test_a_criterion_with_everything() -> None:
    made = criterion(
        segment="up", metric="peak_shaft_torque", upper=564, lower=300, unit="Nm", title="Peak", to_s=5
    )
    assert made.id == "up.peak_shaft_torque"
    assert (made.upper, made.lower, made.title) == (564, 300, "Peak")
    assert "until 5 s after the step" in made.definition


def test_below_another_segment() -> None:
    made = criterion(segment="up", metric="peak_shaft_torque", below="short")
    assert made.id == "up.peak_shaft_torque.below.short"
    assert "lower than in segment short" in made.definition


def test_a_generic_metric_takes_its_parameters() -> None:
    made = criterion(
        segment="sweep",
        metric="band_energy",
        channel="wheel_speed_rad_s",
        from_hz=1,
        to_hz=5,
        unit="(rad/s)^2",
    )
    assert "from 1 to 5 Hz" in made.definition


@pytest.mark.parametrize(
    ("keys", "key", "says"),
    [
        ({}, "metric", "needs a 'metric'"),
        ({"metric": "peak_shaft_torque"}, "segment", "the key 'segment' is missing"),
        ({"metric": "peek"}, "metric", "unknown metric 'peek'\n  did you mean 'peak'?"),
        ({"metric": "peak_shaft_torque", "uper": 3}, "uper", "did you mean 'upper'?"),
        ({"metric": "peak_shaft_torque", "segment": "upp"}, "segment", "did you mean 'up'?"),
        ({"metric": "peak_shaft_torque", "segment": "up", "below": "upp"}, "below", "did you mean 'up'?"),
        (
            {"metric": "peak_shaft_torque", "segment": "up", "below": "up"},
            "below",
            "names the criterion's own segment",
        ),
        (
            {"metric": "peak_shaft_torque", "segment": "up", "below": "short", "upper": 3},
            "upper",
            "is an upper limit already",
        ),
        ({"metric": "peak_shaft_torque", "segment": "up", "unit": "bar"}, "unit", "is 'N m', not 'bar'"),
        ({"metric": "peak_shaft_torque", "segment": "up", "upper": 1, "lower": 2}, "lower", "above upper"),
        ({"metric": "overshoot_shaft_torque", "segment": "up", "lower": 0}, "lower", "is never negative"),
        ({"metric": "peak_shaft_torque", "segment": "up", "upper": "1 kN m"}, "upper", "must be a number"),
        ({"metric": "peak_shaft_torque", "segment": "up", "from_hz": 1}, "from_hz", "unknown key"),
        ({"metric": "peak", "segment": "up", "channel": "shaft_torque"}, "channel", "'shaft_torque_nm'?"),
        ({"metric": "peak", "segment": "up", "channel": "time_s"}, "channel", "unknown channel"),
        ({"metric": "peak_shaft_torque", "segment": "up", "to_s": 30}, "segment", "the segment to 20 s"),
        ({"metric": "band_energy_motor_speed", "segment": "short"}, "segment", "the segment to 10 s"),
        ({"metric": "overshoot_shaft_torque", "segment": "sweep"}, "segment", "a chirp has no step"),
        ({"metric": "overshoot_shaft_torque", "segment": "motor"}, "segment", "give 'reference' in N m"),
        (
            {"metric": "peak_shaft_torque", "segment": "down", "upper": 300},
            "upper",
            "'trough' or 'magnitude'",
        ),
        ({"metric": "peak_shaft_torque", "segment": "down", "below": "up"}, "below", "'magnitude' instead"),
        (
            {"metric": "trough", "channel": "shaft_torque_nm", "segment": "down", "lower": 1},
            "lower",
            "'upper'",
        ),
        ({"metric": "trough", "channel": "shaft_torque_nm", "segment": "up", "upper": 1}, "upper", "'lower'"),
        ({"metric": "response_time_shaft_torque", "segment": "sweep"}, "segment", "choose another metric"),
        (
            {"metric": "overshoot_percent_shaft_torque", "segment": "motor", "reference": 1},
            "segment",
            "give 'step_size' in N m",
        ),
        ({"metric": "settling_shaft_torque", "segment": "sweep"}, "segment", "a chirp has no step"),
        ({"metric": "settling_shaft_torque", "segment": "up", "to_s": 1}, "segment", "the mean alone"),
    ],
)
def test_refused_with_line_and_key(keys: dict[str, Any], key: str, says: str) -> None:
    with pytest.raises(BadInputError) as caught:
        criterion(**keys)
    message = str(caught.value)
    assert f"plan.yaml: line 1, key 'criteria[1].{key}'" in message
    assert says in message


def test_a_reference_makes_a_motor_torque_step_comparable() -> None:
    assert criterion(segment="motor", metric="overshoot_shaft_torque", reference=326).upper is None
    assert criterion(segment="motor", metric="overshoot", channel="motor_torque_nm").upper is None
