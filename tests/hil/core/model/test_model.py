import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil.core.errors import BadInputError
from hil.core.model import EffectUse, load_model, model_from_dict, model_to_toml, parameter_names, save_model

BENCHES = Path(__file__).parents[4] / "benches"


def two_inertia() -> dict[str, Any]:
    return {
        "kind": "two_inertia",
        "parameters": {
            "motor_inertia": 0.02,
            "gear_ratio": 8.148,
            "shaft_stiffness": 6089.0,
            "shaft_damping": 19.75,
            "vehicle_inertia": 303.0,
            "torque_delay": 0.008,
        },
    }


def test_a_kind_that_is_missing_is_called_missing() -> None:
    with pytest.raises(BadInputError, match="kind is missing"):
        model_from_dict({"parameters": {}}, "m.toml")


@pytest.mark.parametrize("name", ["three_inertia", "paper_functions"])
def test_shipped_models_survive_being_written_and_read(name, tmp_path):
    model = load_model(BENCHES / f"{name}.toml")
    save_model(model, tmp_path / "again.toml")
    assert load_model(tmp_path / "again.toml") == model


def test_paper_functions_have_the_resonance_and_gear_ratio_of_the_notes():
    functions = load_model(BENCHES / "paper_functions.toml").transfer_functions
    poles = np.roots(functions["motor_speed_rad_s"].denominator)
    resonance = max(poles, key=lambda p: p.imag)
    assert abs(resonance) / (2 * np.pi) == pytest.approx(10.583, abs=0.001)
    assert -resonance.real / abs(resonance) == pytest.approx(0.163, abs=0.001)
    low = np.array([1e-4])
    ratio = functions["motor_speed_rad_s"].response(low) / functions["wheel_speed_rad_s"].response(low)
    assert abs(ratio[0]) == pytest.approx(8.148, abs=0.001)


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"stiffness": 1.0}, "parameters.stiffness"),
        ({"shaft_stiffness": -1.0}, "parameters.shaft_stiffness"),
        ({"shaft_stiffness": 0.0}, "parameters.shaft_stiffness"),
        ({"shaft_stiffness": math.nan}, "parameters.shaft_stiffness"),
        ({"shaft_stiffness": math.inf}, "parameters.shaft_stiffness"),
        ({"shaft_stiffness": "6089 N m/deg"}, "parameters.shaft_stiffness"),
        ({"torque_delay": True}, "parameters.torque_delay"),
        ({"torque_delay": 8.0}, "parameters.torque_delay"),
    ],
)
def test_a_parameter_that_cannot_be_is_refused_by_name(change, named):
    data = two_inertia()
    data["parameters"] |= change
    with pytest.raises(BadInputError) as caught:
        model_from_dict(data, "m.toml")
    assert named in str(caught.value)
    assert "m.toml" in str(caught.value)


@pytest.mark.parametrize("name", parameter_names("two_inertia"))
def test_each_missing_parameter_is_named(name):
    data = two_inertia()
    del data["parameters"][name]
    with pytest.raises(BadInputError, match=f"parameters.{name}"):
        model_from_dict(data, "m.toml")


def test_effects_are_checked_against_the_registry():
    data = two_inertia() | {"effects": [{"id": "backlash", "half_gap": 0.02}]}
    with pytest.raises(BadInputError, match="half_gap_rad"):
        model_from_dict(data, "m.toml")
    data = two_inertia() | {"effects": [{"id": "slack", "half_gap_rad": 0.02}]}
    with pytest.raises(BadInputError, match="backlash"):
        model_from_dict(data, "m.toml")


def test_an_effect_that_the_kind_cannot_have_is_refused():
    functions = tomllib.loads((BENCHES / "paper_functions.toml").read_text())
    functions["effects"] = [{"id": "backlash", "half_gap_rad": 0.02}]
    with pytest.raises(BadInputError, match="transfer_function"):
        model_from_dict(functions, "m.toml")


def test_optional_parameters_of_an_effect_get_their_defaults():
    data = two_inertia() | {"effects": [{"id": "coulomb_friction", "torque_nm": 1.5}]}
    optional: dict[str, float | str] = {
        "stribeck_torque_nm": 0.0,
        "offset_nm": 0.0,
        "turn_rad": 0.0,
        "stribeck_speed_rad_s": 2.0,
        "stribeck_power": 2.0,
        "bristle_damping_nms_rad": 0.0,
    }
    expected = EffectUse("coulomb_friction", {"torque_nm": 1.5, **optional})
    assert model_from_dict(data, "m.toml").effects == (expected,)


@pytest.mark.parametrize("given_m", [0.0, -0.3, 33.0, float("nan"), "0.33", True])
def test_a_wheel_radius_that_no_wheel_has_is_refused(given_m):
    with pytest.raises(BadInputError, match="wheel_radius_m"):
        model_from_dict(two_inertia() | {"wheel_radius_m": given_m}, "m.toml")


def test_a_wheel_radius_is_kept(tmp_path):
    model = model_from_dict(two_inertia() | {"wheel_radius_m": 0.3}, "m.toml")
    save_model(model, tmp_path / "m.toml")
    assert load_model(tmp_path / "m.toml").wheel_radius_m == 0.3
    assert model_from_dict(two_inertia(), "m.toml").wheel_radius_m == 0.33


json_values = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8), inner, max_size=3),
    max_leaves=8,
)


@given(
    st.dictionaries(
        st.sampled_from(["kind", "parameters", "effects", "transfer_functions", "x"]), json_values
    )
)
def test_whatever_a_file_holds_it_is_a_model_or_bad_input(data):
    try:
        model = model_from_dict(data, "m.toml")
    except BadInputError:
        return
    assert model_from_dict(tomllib.loads(model_to_toml(model)), "again") == model


@given(key=st.sampled_from(["kind", "parameters", "effects"]), value=json_values)
def test_one_wrong_entry_in_a_good_file_is_bad_input(key, value):
    data = two_inertia() | {key: value}
    try:
        model_from_dict(data, "m.toml")
    except BadInputError:
        return
    assert value in ([], data[key])


def test_a_function_without_a_delay_has_none():
    function = {"numerator": [1.0], "denominator": [2.0, 1.0]}
    data = {"kind": "transfer_function", "transfer_functions": {"motor_speed_rad_s": function}}
    assert model_from_dict(data, "here").transfer_functions["motor_speed_rad_s"].delay_s == 0.0
    for part in ("numerator", "denominator"):
        for wrong in (list[float](), 3.0, None):
            broken = {**data, "transfer_functions": {"motor_speed_rad_s": {**function, part: wrong}}}
            with pytest.raises(BadInputError, match=f"{part} is missing: a list"):
                model_from_dict(broken, "here")


def test_how_well_parameters_are_known_is_kept_and_checked():
    data = two_inertia() | {"tolerance": {"shaft_stiffness": 0.3}}
    model = model_from_dict(data, "model.toml")
    assert model.tolerance == {"shaft_stiffness": 0.3}
    assert model_from_dict(tomllib.loads(model_to_toml(model)), "again.toml") == model
    for name, value in (("stiffness", 0.1), ("shaft_stiffness", 30), ("shaft_stiffness", 0.0)):
        with pytest.raises(BadInputError, match="tolerance"):
            model_from_dict(two_inertia() | {"tolerance": {name: value}}, "model.toml")
