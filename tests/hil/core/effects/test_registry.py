"""The registry: every effect says all that others read of it, and says it consistently."""

import inspect
from pathlib import Path

import pytest

import hil.core.effects as package
from hil.core.effects import EFFECTS, SENSED, Effect, Law, Parameter, Stage
from hil.core.effects._page import page
from hil.core.errors import BadInputError
from hil.core.model import model_from_dict

CONTRACT = {
    "dead_time": ("extra_delay_s",),
    "actuator_lag": ("time_constant_s",),
    "torque_saturation": ("limit_nm",),
    "torque_rate_limit": ("limit_nm_s",),
    "torque_deadband": ("half_width_nm",),
    "torque_gain": ("gain",),
    "motor_limits": (
        "power_w",
        "peak_nm",
        "regenerated_w",
        "state_of_charge",
        "low_charge",
        "high_charge",
        "temperature_deg_c",
        "warm_deg_c",
        "hot_deg_c",
    ),
    "backlash": (
        "half_gap_rad",
        "contact_damping_nms_rad",
        "restitution",
        "depth_damping_nms_rad2",
        "tension",
        "contact_depth_rad",
        "one_spring",
        "film",
    ),
    "shaft_cubic_stiffness": ("coefficient_nm_rad3",),
    "shaft_hysteresis": ("stiffness_nm_rad", "slip_rad"),
    "coulomb_friction": (
        "torque_nm",
        "stribeck_torque_nm",
        "offset_nm",
        "turn_rad",
        "stribeck_speed_rad_s",
        "stribeck_power",
        "bristle_damping_nms_rad",
    ),
    "viscous_drag": ("coefficient_nms_rad",),
    "mount_mode": ("housing_inertia_kg_m2", "mount_stiffness_nm_rad", "mount_damping_nms_rad"),
    "tyre_compliance": ("wheel_inertia", "tyre_stiffness", "tyre_damping"),
    "wheel_order_disturbance": ("order", "amplitude_nm", "phase_rad"),
    "motor_order_ripple": ("order", "amplitude_nm", "phase_rad"),
    "tyre_slip": ("slip_stiffness_nm", "relaxation_length_m"),
    "tyre_friction": (
        "peak_nm",
        "sliding_nm",
        "fades_at_rad_s",
        "patch_friction",
        "patch_length_m",
        "road_friction",
    ),
    "separate_wheels": ("differential_friction_nm", "friction_left", "friction_right"),
    "dyno_lag": ("time_constant_s",),
    "running_resistance": ("rolling_nm", "aero_nms2_rad2"),
    "load_coulomb_friction": ("torque_nm", "offset_nm"),
    "load_viscous_drag": ("coefficient_nms_rad",),
    "sensor_gain": ("gain",),
    "sensor_offset": ("offset",),
    "channel_skew": ("delay_s",),
    "sensor_lag": ("time_constant_s",),
    "sensor_quantization": ("step",),
    "parameter_mismatch": ("value",),
}
every = pytest.mark.parametrize("effect", EFFECTS.values(), ids=list(EFFECTS))


def test_the_names_are_those_that_others_rely_on():
    assert {id_: tuple(p.name for p in effect.parameters) for id_, effect in EFFECTS.items()} == CONTRACT


def test_every_file_of_the_package_is_one_effect():
    files = {path.stem for path in Path(package.__file__).parent.glob("[a-z]*.py")}
    assert files == set(EFFECTS)


def test_the_page_is_what_stands_in_the_files():
    kept = Path(__file__).parents[4] / "docs/reference/effects.md"
    assert kept.read_text(encoding="utf-8") == page()


def test_they_stand_in_the_order_in_which_they_act():
    stages = [list(Stage).index(effect.stage) for effect in EFFECTS.values()]
    assert stages == sorted(stages)


@every
def test_kin_are_effects(effect: Effect):
    assert set(effect.similar) <= set(EFFECTS) - {effect.id}


@every
def test_what_turns_it_off_is_one_of_its_numbers(effect: Effect):
    for name in effect.acting():
        assert effect.parameter(name).name == name
    with pytest.raises(KeyError):
        effect.parameter("no such number")


@every
def test_it_acts_somewhere_and_what_it_remembers_has_a_place(effect: Effect):
    law = effect.law
    assert law.compiled or law.chain is not None or law.reads is not None
    assert (law.remember is not None) == (effect.memory is not None)
    if law.begin is not None or law.stretch is not None:
        assert effect.memory is not None


@every
def test_optional_numbers_have_defaults_within_their_bounds(effect: Effect):
    for parameter in effect.parameters:
        if parameter.optional:
            assert parameter.lower <= parameter.default <= parameter.upper
        for value in parameter.opens:
            low, high = parameter.within or (parameter.lower, parameter.upper)
            assert parameter.optional
            assert parameter.fitted
            assert low <= value <= high


@every
def test_a_choice_is_between_the_default_and_other_values_and_no_fit_moves_it(effect: Effect):
    for parameter in effect.parameters:
        if parameter.choices:
            assert parameter.optional
            assert not parameter.fitted
            assert not parameter.opens
            assert parameter.default in parameter.choices
            assert all(parameter.lower <= value <= parameter.upper for value in parameter.choices)


@every
def test_a_number_that_needs_another_needs_an_optional_one_that_is_tried(effect: Effect):
    for parameter in effect.parameters:
        if parameter.beside:
            assert parameter.optional
            assert all(
                effect.parameter(one).opens or effect.parameter(one).choices for one in parameter.beside
            )


@every
def test_a_law_has_no_statement_that_cannot_be_compiled(effect: Effect):
    for function in vars(effect.law).values():
        if inspect.isfunction(function) and effect.law.compiled:
            assert "del " not in inspect.getsource(function)


def test_a_law_that_does_nothing_is_not_compiled():
    assert not Law().compiled
    assert Law(shaft=lambda m, c, z, v: 0.0).compiled


def test_a_number_is_moved_by_its_logarithm_unless_it_has_a_typical_size():
    assert Parameter("x", "", 0.0, 1.0, "").typical is None


def test_every_sensor_effect_is_about_a_channel():
    for effect in EFFECTS.values():
        assert (effect.law.reads is not None) == (effect.text_parameters == ("channel",))
    assert "shaft_torque_nm" in SENSED


def test_an_effect_on_top_of_a_third_inertia_needs_that_inertia_first():
    chain = {
        "motor_inertia": 0.02,
        "gear_ratio": 8.0,
        "shaft_stiffness": 6000.0,
        "shaft_damping": 20.0,
        "vehicle_inertia": 300.0,
        "torque_delay": 0.008,
    }
    tyre = {"id": "tyre_compliance", "wheel_inertia": 4.0, "tyre_stiffness": 5e3, "tyre_damping": 300.0}
    slip = {"id": "tyre_slip", "slip_stiffness_nm": 8e3, "relaxation_length_m": 0.4}
    model = model_from_dict({"kind": "two_inertia", "parameters": chain, "effects": [tyre, slip]}, "here")
    assert [use.id for use in model.effects] == ["tyre_compliance", "tyre_slip"]
    with pytest.raises(BadInputError, match="tyre_slip"):
        model_from_dict({"kind": "two_inertia", "parameters": chain, "effects": [slip]}, "here")
