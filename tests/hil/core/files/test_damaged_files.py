"""Model and controller files, damaged in every way: a message that says what and where, never a traceback."""

from __future__ import annotations

import copy
import math
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import tomli_w
from hypothesis import given, settings
from hypothesis import strategies as st

from hil.core.controller import controller_from_toml, load_controller
from hil.core.effects import SENSED
from hil.core.errors import BadInputError
from hil.core.files.toml_file import LARGEST_BYTES
from hil.core.model import load_model, model_from_dict, parameter_names
from hil.plant import simulate

BENCHES = Path(__file__).parents[4] / "benches"
MODELS = [
    tomllib.loads((BENCHES / f"{name}.toml").read_text()) for name in ("three_inertia", "paper_functions")
]
CONTROLLER = tomllib.loads("""
name = "phase"
torque_limit_nm = 150.0
[dfc]
integral_gain = 0.001
feedforward_time_constant_s = 0.05
[wsc]
proportional_gain = 2.7
integral_gain = 0.4
filter_time_constant_s = 0.05
lead = {alpha = 0.26, time_constant_s = 0.0078}
[dfo]
time_constant_s = 0.008
gear_ratio = 8.148
wheel_inertia_kg_m2 = 4.355
[plant]
denominator = [1.0, 71.59, 6376.0]
motor_speed = [46.35, 2604.0]
wheel_speed = [45.99]
shaft_torque = [212.7, 5.2e4]
""")


def with_effects(*entries: dict[str, Any], model: dict[str, Any] = MODELS[0]) -> dict[str, Any]:
    return {**copy.deepcopy(model), "effects": list(entries)}


@pytest.mark.parametrize(
    "effect",
    [
        {"id": "sensor_gain", "gain": 1.1},
        {"id": "sensor_offset", "offset": 1.0},
        {"id": "channel_skew", "delay_s": 0.01},
        {"id": "sensor_quantization", "step": 0.1},
    ],
)
@pytest.mark.parametrize("model", MODELS, ids=["chain", "functions"])
def test_a_channel_that_no_model_gives_is_refused_by_name(
    effect: dict[str, Any], model: dict[str, Any]
) -> None:
    with pytest.raises(BadInputError) as caught:
        model_from_dict(with_effects({**effect, "channel": "foo"}, model=model), "m.toml")
    assert "'foo'" in caught.value.what
    assert all(name in caught.value.fix for name in SENSED)
    for channel in SENSED:
        model_from_dict(with_effects({**effect, "channel": channel}, model=model), "m.toml")


@pytest.mark.parametrize("parameter", ["vehicle_inerta", "viscous_drag", "kind", ""])
def test_a_mismatch_of_a_parameter_that_the_model_lacks_is_refused(parameter: str) -> None:
    entry = {"id": "parameter_mismatch", "parameter": parameter, "value": 300.0}
    with pytest.raises(BadInputError, match="parameter"):
        model_from_dict(with_effects(entry), "m.toml")


@pytest.mark.slow
def test_a_mismatch_speaks_of_what_the_kind_has() -> None:
    entry = {"id": "parameter_mismatch", "parameter": "vehicle_inertia", "value": 300.0}
    simulate(model_from_dict(with_effects(entry), "m.toml"), [1.0] * 10, 1e-3)  # type: ignore[arg-type]
    with pytest.raises(BadInputError, match="it has: none"):
        raise_what_is_said(lambda: model_from_dict(with_effects(entry, model=MODELS[1]), "m.toml"))
    for value in (-1.0, 0.0, 1e-13):
        with pytest.raises(BadInputError, match="vehicle_inertia"):
            model_from_dict(with_effects({**entry, "value": value}), "m.toml")


def raise_what_is_said(call: Callable[[], object]) -> None:
    """The message with its advice, as people see it."""
    try:
        call()
    except BadInputError as error:
        raise BadInputError(str(error)) from error


@pytest.mark.parametrize(
    ("entries", "twice"),
    [
        ([{"id": "backlash", "half_gap_rad": 0.01}, {"id": "backlash", "half_gap_rad": 0.02}], True),
        ([{"id": "sensor_gain", "channel": c, "gain": 1.1} for c in SENSED[:1] * 2], True),
        ([{"id": "sensor_gain", "channel": c, "gain": 1.1} for c in SENSED[:2]], False),
    ],
)
def test_an_effect_stands_once(entries: list[dict[str, Any]], twice: bool) -> None:
    if not twice:
        assert len(model_from_dict(with_effects(*entries), "m.toml").effects) == len(entries)
        return
    with pytest.raises(BadInputError, match="stands twice"):
        model_from_dict(with_effects(*entries), "m.toml")


@pytest.mark.parametrize(
    "value", [10**400, -(10**5000), math.nan, math.inf, 1e300, 1e-300, True, "1", None, []], ids=type
)
def test_a_number_that_is_none_is_refused_wherever_it_stands(value: object) -> None:
    for name in parameter_names("three_inertia"):
        data = copy.deepcopy(MODELS[0])
        data["parameters"][name] = value
        if name == "torque_delay" and value == 1e-300:
            continue
        with pytest.raises(BadInputError, match=name):
            model_from_dict(data, "m.toml")
    if not isinstance(value, float) or abs(value) != 1e-300:
        with pytest.raises(BadInputError, match="half_gap_rad"):
            model_from_dict(with_effects({"id": "backlash", "half_gap_rad": value}), "m.toml")


def damaged() -> dict[str, bytes]:
    good = (BENCHES / "three_inertia.toml").read_bytes()
    return {
        "broken": good[: len(good) // 2] + b"= = [",
        "binary": bytes(range(256)) * 20,
        "zeros": bytes(1000),
        "empty": b"",
        "large": b"# comment\n" * (LARGEST_BYTES // 10 + 1),
        "deep": b"meta = " + b"[" * 20_000,
        "digits": b"kind = " + b"9" * 10_000,
        "date": b"kind = 2021-13-45",
        "text": b"a recording, perhaps?\n",
        "table": b"time_s,motor_speed_rad_s\n0,1\n",
    }


@pytest.mark.parametrize("load", [load_model, load_controller])
@pytest.mark.parametrize("name", damaged())
def test_a_file_that_is_none_is_refused_with_its_name(
    name: str, load: Callable[[Path], object], tmp_path: Path
) -> None:
    path = tmp_path / f"{name}.toml"
    path.write_bytes(damaged()[name])
    with pytest.raises(BadInputError) as caught:
        load(path)
    assert caught.value.where.startswith(str(path))
    assert len(str(caught.value)) < 1000
    for other in (tmp_path, tmp_path / "none.toml"):
        with pytest.raises(BadInputError):
            load(other)


SCALARS = st.one_of(
    st.none(),
    st.booleans(),
    st.floats(),
    st.integers(),
    st.sampled_from([10**400, -1, 0, "", "x", "backlash", [], {}, [[]], {"id": "x"}, [1, "a"], [math.nan]]),
)


@st.composite
def mutated(draw: st.DrawFn, good: dict[str, Any]) -> dict[str, Any]:
    """A good file with one to three entries changed, removed, added or doubled, at any depth."""
    data = copy.deepcopy(good)
    for _ in range(draw(st.integers(1, 3))):
        place: Any = data
        while True:
            keys = list(place) if isinstance(place, dict) else list(range(len(place)))
            if not keys:
                break
            key = draw(st.sampled_from(keys))
            if isinstance(place[key], dict | list) and draw(st.booleans()):
                place = place[key]
                continue
            if draw(st.booleans()):
                place[key] = draw(SCALARS)
            elif draw(st.booleans()):
                del place[key]
            elif isinstance(place, list):
                place.append(copy.deepcopy(place[key]))
            else:
                place[f"{key}_"] = place[key]
            break
    return data


RICH = with_effects(
    {"id": "backlash", "half_gap_rad": 0.02},
    {"id": "sensor_gain", "channel": "wheel_speed_rad_s", "gain": 1.1},
    {"id": "parameter_mismatch", "parameter": "vehicle_inertia", "value": 300.0},
)


@given(st.one_of(mutated(RICH), mutated(MODELS[1])))
@settings(max_examples=150, deadline=None)
def test_a_mutated_model_is_a_model_or_bad_input(data: dict[str, Any]) -> None:
    try:
        model_from_dict(data, "m.toml")
    except BadInputError as error:
        assert "m.toml" in error.where


@given(mutated(CONTROLLER))
@settings(max_examples=100, deadline=None)
def test_a_mutated_controller_is_one_or_bad_input(data: dict[str, Any]) -> None:
    try:
        text = tomli_w.dumps(data)
    except (TypeError, ValueError):
        return  # no TOML file holds this
    try:
        controller_from_toml(text, "c.toml")
    except BadInputError as error:
        assert error.where.split(",")[0] == "c.toml"


@given(data=st.data())
@settings(max_examples=100, deadline=None)
def test_bytes_changed_in_a_file_are_a_model_or_bad_input(
    data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    content = bytearray((BENCHES / "three_inertia.toml").read_bytes())
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(content) - 1))
        content[at : at + data.draw(st.integers(0, 3))] = data.draw(st.binary(max_size=3))
    path = tmp_path_factory.getbasetemp() / "mutated.toml"
    path.write_bytes(bytes(content))
    try:
        load_model(path)
    except BadInputError as error:
        assert str(path) in error.where
