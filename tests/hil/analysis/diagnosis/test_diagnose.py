"""The whole way from recordings to names, on data of a plant with other formulas."""

from __future__ import annotations

import json

import pytest

from hil.analysis.diagnosis import Diagnosis, diagnose
from hil.core.effects import EFFECTS
from hil.core.errors import BadInputError
from hil.core.model import Model, model_from_dict, model_to_toml
from tests.hil.analysis.diagnosis.reference_plant import BASE, Truth, recordings

MODEL = Model("three_inertia", dict(BASE))


def names(found: Diagnosis) -> list[str]:
    return [e.use.id for e in found.effects]


def test_nothing_is_named_where_nothing_is_missing() -> None:
    found = diagnose(MODEL, recordings(Truth(), 1, short=True))
    assert (found.verdict, names(found)) == ("none", [])
    assert all(g.gap < 1.05 * g.noise_floor for g in found.gap_after.values())


@pytest.mark.parametrize(
    ("truth", "effect", "parameter", "value"),
    [
        (Truth({"torque_delay": 0.011}), "dead_time", "extra_delay_s", 0.003),
        (Truth(saturation=20.0), "torque_saturation", "limit_nm", 20.0),
        (Truth({"coulomb": 1.0}), "coulomb_friction", "torque_nm", 1.0),
        (Truth(offset={"motor_speed_rad_s": 1.0}), "sensor_offset", "offset", 1.0),
        (Truth({"shaft_stiffness": 7000.0}), "parameter_mismatch", "value", 7000.0),
        (Truth(step={"wheel_speed_rad_s": 0.1}), "sensor_quantization", "step", 0.1),
    ],
)
def test_a_single_effect_is_named_alone(truth: Truth, effect: str, parameter: str, value: float) -> None:
    found = diagnose(MODEL, recordings(truth, 2, short=True))
    assert names(found) == [effect]
    assert float(found.effects[0].use.values[parameter]) == pytest.approx(value, rel=0.03)
    assert (
        all(g.gap < 1.2 * g.noise_floor for g in found.gap_after.values()) or effect == "sensor_quantization"
    )


def test_two_effects_are_named_and_held_out_data_agree() -> None:
    truth = Truth({"drag": 0.01}, gain={"shaft_torque_nm": 1.06})
    all_of_them = recordings(truth, 3, short=True)
    found = diagnose(MODEL, all_of_them[:5], all_of_them[5:])
    assert sorted(names(found)) == ["sensor_gain", "viscous_drag"]
    assert all(g.gap < 1.1 * g.noise_floor for g in found.holdout_after.values())


def test_an_unknown_line_is_described_and_not_named() -> None:
    found = diagnose(MODEL, recordings(Truth({"torque_line_hz": 13.0, "torque_line_nm": 1.0}), 4, short=True))
    assert found.verdict == "unknown"
    assert names(found) == []
    assert "line at 13" in found.signature or "line at 12." in found.signature


def test_the_result_is_a_model_file_and_plain_json() -> None:
    found = diagnose(MODEL, recordings(Truth(saturation=20.0), 5, short=True))
    text = json.loads(json.dumps(found.as_json()))
    assert set(text) >= {
        "verdict",
        "effects",
        "parameter_updates",
        "alternatives",
        "gap",
        "holdout_gap",
        "model",
    }
    assert set(text["effects"][0]) == {"id", "parameters", "standard_error", "confidence", "where"}
    import tomllib

    again = model_from_dict(tomllib.loads(model_to_toml(found.model)), "test")
    assert again.effects[0].id == "torque_saturation"
    assert all(EFFECTS[use.id] for use in again.effects)


def test_inverted_and_swapped_channels_are_refused_by_name() -> None:
    good = recordings(Truth(), 6, short=True, only=("chirp_low", "steps"))
    for recording in good:
        recording.channels["wheel_speed_rad_s"] *= -1
    with pytest.raises(BadInputError, match="wheel_speed_rad_s looks inverted"):
        diagnose(MODEL, good)
    for recording in good:
        recording.channels["wheel_speed_rad_s"] *= -1
        c = recording.channels
        c["wheel_speed_rad_s"], c["motor_speed_rad_s"] = c["motor_speed_rad_s"], c["wheel_speed_rad_s"]
    with pytest.raises(BadInputError, match="swapped"):
        diagnose(MODEL, good)


def test_a_wrong_gear_ratio_and_a_dead_channel_are_refused() -> None:
    good = recordings(Truth(), 6, short=True, only=("chirp_low", "steps"))
    with pytest.raises(BadInputError, match="gear ratio"):
        diagnose(MODEL.with_parameters(gear_ratio=4.0), good)
    for recording in good:
        recording.channels["shaft_torque_nm"][:] = 3.0
    with pytest.raises(BadInputError, match="shaft_torque_nm looks dead"):
        diagnose(MODEL, good)
