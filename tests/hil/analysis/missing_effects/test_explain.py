"""The whole way, on a turning mass by formulas of its own."""

from __future__ import annotations

import numpy as np
import pytest

from hil.analysis.missing_effects import Outcome, explain_gap, series_of
from hil.core.errors import BadInputError
from hil.core.model import EffectUse, Model
from hil.core.recording import Recording
from tests.hil.analysis.missing_effects.chain import NUMBERS, chirp
from tests.hil.analysis.missing_effects.turning_mass import arm, base, recording

pytestmark = pytest.mark.slow


def _asked(model: Model, *truth: float, torque_nm: float = 20.0) -> Outcome:
    fit, held = (recording(*truth, torque_nm=torque_nm, seed=seed) for seed in (0, 5))
    return explain_gap(model, series_of(model, [fit]), series_of(model, [held]))


@pytest.mark.parametrize("model", [base(0.54), base(0.54, 2.17), base(0.27), base(1.62)])
def test_dry_friction_is_named_from_any_base(model: Model) -> None:
    found = _asked(model, 0.54, 2.17, 1.39)
    assert found.verdict == "named"
    assert [one.id for one in found.effects if one.id != "parameter_mismatch"] == ["coulomb_friction"]
    friction = found.effects[0]
    assert friction.confidence > 0.95
    assert friction.use.values["torque_nm"] == pytest.approx(1.39, rel=0.005)
    assert found.numbers["viscous_drag"][1] == pytest.approx(2.17, rel=0.005)
    held = found.held_out[0]
    left = held.series.samples[:, 0] - held.outputs(found.model)[:, 0]
    assert np.std(left) < 1.1 * found.noise[0]
    assert found.model.effects[0].id == "coulomb_friction"


@pytest.mark.parametrize(("carried_nm", "hidden_nm"), [(0.7, 1.39), (1.39, 0.3)])
def test_a_wrong_number_of_an_effect_that_the_base_carries_is_named(
    carried_nm: float, hidden_nm: float
) -> None:
    model = base(0.54, 2.17).with_effects(EffectUse("coulomb_friction", {"torque_nm": carried_nm}))
    found = _asked(model, 0.54, 2.17, hidden_nm)
    assert [one.use.values.get("parameter") for one in found.effects] == ["coulomb_friction.torque_nm"]
    assert found.effects[0].use.values["value"] == pytest.approx(hidden_nm, rel=0.01)
    assert found.effects[0].confidence > 0.95
    assert found.model.effects[0].values["torque_nm"] == pytest.approx(hidden_nm, rel=0.01)


def test_gravity_beside_dry_friction_is_a_ripple_once_a_turn() -> None:
    found = _asked(base(1.6), 0.54, 1.0, 0.3, 4.0, torque_nm=6.0)
    names = {one.id: one.use.values for one in found.effects}
    assert names.keys() == {"coulomb_friction", "motor_order_ripple"}
    assert names["motor_order_ripple"]["order"] == pytest.approx(1.0, abs=0.01)
    assert names["motor_order_ripple"]["amplitude_nm"] == pytest.approx(4.0, rel=0.01)
    assert names["coulomb_friction"]["torque_nm"] == pytest.approx(0.3, rel=0.05)


@pytest.mark.parametrize("model", [base(0.54, 1.0), base(0.27), base(1.62)])
def test_gravity_of_an_arm_that_turns_less_than_once_is_named_from_its_encoder(model: Model) -> None:
    """Once a turn is what gravity does: half a period of it does.

    It seldom rests: where it turns, a rolling resistance without air is the same as dry friction.
    """
    found = explain_gap(model, series_of(model, [arm(1)]), series_of(model, [arm(2)]))
    ripple, friction = sorted(found.effects, key=lambda one: one.id != "motor_order_ripple")
    assert ripple.use.values["order"] == pytest.approx(1.0, abs=0.02)
    assert ripple.use.values["amplitude_nm"] == pytest.approx(4.0, rel=0.02)
    assert {friction.id, *friction.alike} <= {"coulomb_friction", "running_resistance"}
    assert "coulomb_friction" in (friction.id, *friction.alike)
    size = friction.use.values.get("torque_nm", friction.use.values.get("rolling_nm"))
    assert size == pytest.approx(0.3, rel=0.05)
    assert found.numbers["motor_inertia"][1] == pytest.approx(0.54, rel=0.01)
    assert found.numbers["viscous_drag"][1] == pytest.approx(1.0, rel=0.02)


@pytest.mark.parametrize(
    ("truth", "name", "numbers"),
    [
        ({"power_w": 80.0}, "motor_limits", {"power_w": 80.0, "peak_nm": 1e6}),
        ({"power_w": 50.0, "peak_nm": 12.0}, "motor_limits", {"power_w": 50.0, "peak_nm": 12.0}),
        ({"peak_nm": 12.0}, "torque_saturation", {"limit_nm": 12.0}),
    ],
)
def test_a_limited_motor_is_named_with_the_limits_that_were_met(
    truth: dict[str, float], name: str, numbers: dict[str, float]
) -> None:
    fit, held = (recording(0.54, 2.17, seed=seed, **truth) for seed in (0, 5))
    model = base(0.54, 2.17)
    found = explain_gap(model, series_of(model, [fit]), series_of(model, [held]))
    assert [one.id for one in found.effects] == [name]
    assert found.effects[0].confidence > 0.95
    for number, value in numbers.items():
        assert found.effects[0].use.values[number] == pytest.approx(value, rel=0.005)
    left = held["motor_speed_rad_s"] - found.held_out[0].outputs(found.model)[:, 0]
    assert np.std(left) < 1.05 * found.noise[0]


def test_a_right_base_has_nothing_missing_and_a_wrong_number_is_named() -> None:
    right = _asked(base(0.54, 2.17), 0.54, 2.17)
    assert (right.verdict, right.effects) == ("none", ())
    wrong = _asked(base(0.54, 2.0), 0.54, 2.17)
    assert [one.use.values["parameter"] for one in wrong.effects] == ["viscous_drag"]
    assert wrong.effects[0].use.values["value"] == pytest.approx(2.17, rel=0.001)


def test_a_gear_ratio_that_moved_shares_its_name_with_gains_of_both_speeds() -> None:
    """Of two speeds the data know only the ratio."""
    fit = recording(0.54, 2.17)
    rng = np.random.default_rng(9)
    fit.channels["wheel_speed_rad_s"] = 1.03 * fit["motor_speed_rad_s"] + rng.normal(0.0, 0.02, fit.samples)
    model = base(0.54, 2.17)
    (ratio,) = explain_gap(model, series_of(model, [fit])).effects
    assert ratio.use.values["parameter"] == "gear_ratio"
    assert ratio.use.values["value"] == pytest.approx(1.0 / 1.03, rel=1e-3)
    assert ratio.alike == ("sensor_gain(wheel_speed_rad_s)", "sensor_gain(motor_speed_rad_s)")
    assert ratio.separating_test


def test_a_recording_without_outputs_is_refused() -> None:
    whole = recording(0.54, 2.17, seconds=5.0)
    channels = {name: whole[name] for name in ("time_s", "motor_torque_ref_nm")}
    with pytest.raises(BadInputError, match="none of"):
        series_of(base(0.54), [Recording(channels, whole.source)])


def test_nothing_is_missing_where_stamps_jitter() -> None:
    """The readings keep the clock, as of a device that is logged when its messages come in."""
    whole, model = chirp(0.005), Model("two_inertia", NUMBERS)
    time = whole["time_s"] + np.random.default_rng(3).uniform(-2e-4, 2e-4, whole.samples)
    kept = np.random.default_rng(4).random(whole.samples) > 0.005
    stamped = {name: values[kept] for name, values in {**whole.channels, "time_s": time}.items()}
    found = explain_gap(model, series_of(model, [Recording(stamped, whole.source)]))
    assert (found.verdict, found.effects) == ("none", ())
    assert found.numbers["torque_delay"][1] == pytest.approx(NUMBERS["torque_delay"], abs=3e-5)


def test_a_right_base_with_rounded_readings_has_rounding_alone() -> None:
    fit = recording(0.54, 2.17, noise_rad_s=0.002)
    fit.channels["motor_speed_rad_s"] = np.round(fit["motor_speed_rad_s"] / 0.05) * 0.05
    found = explain_gap(base(0.54, 2.17), series_of(base(0.54, 2.17), [fit]))
    assert [(one.id, one.use.values["channel"]) for one in found.effects] == [
        ("sensor_quantization", "motor_speed_rad_s")
    ]
    assert found.effects[0].use.values["step"] == pytest.approx(0.05)


def test_a_late_torque_and_outputs_that_are_late_alike_are_one_class() -> None:
    late = chirp(0.01, EffectUse("actuator_lag", {"time_constant_s": 0.008}))
    found = explain_gap(Model("two_inertia", NUMBERS), series_of(Model("two_inertia", NUMBERS), [late]))
    named = next(one for one in found.effects if one.id == "actuator_lag")
    assert any(name.count("sensor_lag") == 3 for name in named.alike)
    assert named.use.values["time_constant_s"] == pytest.approx(0.008, rel=0.05)


@pytest.mark.parametrize("late_s", [0.0015, 0.02])
def test_a_skew_of_the_only_output_and_a_dead_time_are_one_class(late_s: float) -> None:
    """Whichever of them the base's dead time of 4 ms makes the likelier."""
    late = chirp(0.01, EffectUse("channel_skew", {"channel": "shaft_torque_nm", "delay_s": late_s}))
    alone = {name: late[name] for name in ("time_s", "motor_torque_ref_nm", "shaft_torque_nm")}
    model = Model("two_inertia", NUMBERS)
    found = explain_gap(model, series_of(model, [Recording(alone, late.source)]))
    (named,) = found.effects
    said = {named.use.values.get("parameter", named.id), *named.alike}
    assert said & {"torque_delay", "dead_time"}
    assert said & {"channel_skew", "channel_skew(shaft_torque_nm)"}
    assert named.separating_test


def test_air_drag_that_does_not_show_costs_a_rolling_resistance_nothing() -> None:
    """Without air it brakes the load of two inertias as dry friction there does: one class."""
    fit = chirp(0.01, EffectUse("running_resistance", {"rolling_nm": 20.0, "aero_nms2_rad2": 0.0}))
    model = Model("two_inertia", NUMBERS)
    (named,) = explain_gap(model, series_of(model, [fit])).effects
    assert {named.id, *named.alike} >= {"running_resistance", "load_coulomb_friction"}
    assert named.use.values.get("aero_nms2_rad2", 0.0) == 0.0


def test_dry_friction_is_named_from_an_encoder_alone() -> None:
    """Readings in steps of 2 mrad; no speed was recorded. The same number as from a speed without noise."""
    fit, held = (_by_encoder(recording(0.54, 2.17, 1.39, noise_rad_s=0.0, seed=seed)) for seed in (0, 5))
    found = explain_gap(base(0.54), series_of(base(0.54), [fit]), series_of(base(0.54), [held]))
    assert [one.id for one in found.effects if one.id != "parameter_mismatch"] == ["coulomb_friction"]
    friction = found.effects[0]
    assert friction.confidence > 0.95
    assert friction.use.values["torque_nm"] == pytest.approx(1.39, rel=0.005)
    assert found.numbers["viscous_drag"][1] == pytest.approx(2.17, rel=0.005)
    for one in found.held_out:
        left = one.series.samples[:, 0] - one.outputs(found.model)[:, 0]
        assert np.std(left) < 1.15 * found.noise[0]
        assert np.max(np.abs(one.series.angle[:, 0] - one.angle(found.model)[:, 0])) < 0.1


def _by_encoder(one: Recording) -> Recording:
    """The same, the motor's angle on a grid in place of its speed."""
    speed = one["motor_speed_rad_s"]
    angle = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]))]) * one.sample_time_s
    channels = {name: one[name] for name in ("time_s", "motor_torque_ref_nm")}
    return Recording(channels | {"motor_angle_rad": np.round(angle / 2e-3) * 2e-3}, one.source)


_TAKEN = pytest.mark.xfail(strict=True, reason="friction that turns around over 0.3 rad is named with 0.77")


@pytest.mark.parametrize("torque_nm", [1.0, pytest.param(2.0, marks=_TAKEN)])
def test_gravity_over_less_than_half_a_turn_is_no_friction(torque_nm: float) -> None:
    """It is a spring, as is dry friction that turns around over more than the arm turns."""
    found = _asked(base(0.54, 1.0), 0.54, 1.0, 0.0, 4.0, torque_nm=torque_nm)
    assert "coulomb_friction" not in [one.id for one in found.effects]
