"""Schemas of model and controller files: what is shipped is valid, what the reader refuses is not."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import jsonschema
import pytest

import benches
import test_plans
from hil.core.controller import controller_schema
from hil.core.effects import EFFECTS
from hil.core.model.schema import model_schema

BENCHES = Path(benches.__file__).parent
MODEL = jsonschema.Draft202012Validator(model_schema())
CONTROLLER = jsonschema.Draft202012Validator(controller_schema())
MODELS = [path for path in BENCHES.glob("*.toml") if "\nkind = " in f"\n{path.read_text('utf-8')}"]
CONTROLLERS = list((Path(test_plans.__file__).parent / "library/controllers").glob("*.toml"))
AXLE = tomllib.loads((BENCHES / "three_inertia.toml").read_text("utf-8"))


def test_they_are_schemas() -> None:
    jsonschema.Draft202012Validator.check_schema(model_schema())
    jsonschema.Draft202012Validator.check_schema(controller_schema())


@pytest.mark.parametrize("path", [p for p in MODELS if "[parameters]" in p.read_text("utf-8")], ids=str)
def test_shipped_models_are_valid(path) -> None:
    MODEL.validate(tomllib.loads(path.read_text("utf-8")))


@pytest.mark.parametrize("path", CONTROLLERS, ids=str)
def test_shipped_controllers_are_valid(path) -> None:
    CONTROLLER.validate(tomllib.loads(path.read_text("utf-8")))


@pytest.mark.parametrize(
    "change",
    [
        {"kind": "four_inertia"},
        {"parametres": {}},
        {"parameters": AXLE["parameters"] | {"mass": 1.0}},
        {"parameters": {k: v for k, v in AXLE["parameters"].items() if k != "gear_ratio"}},
        {"effects": [{"id": "backlash"}]},
        {"effects": [{"id": "backlash", "half_gap_rad": -1.0}]},
        {"effects": [{"id": "backslash", "half_gap_rad": 0.01}]},
        {"effects": [{"id": "sensor_gain", "channel": "speed", "gain": 1.1}]},
        {"transfer_functions": {"motor_speed_rad_s": {"numerator": [1.0], "denominator": [1.0, 2.0]}}},
        {"load_input": "speed"},
    ],
    ids=str,
)
def test_what_a_model_may_not_have_is_not_valid(change: dict[str, Any]) -> None:
    MODEL.validate(AXLE)
    with pytest.raises(jsonschema.ValidationError):
        MODEL.validate(AXLE | change)


def test_every_effect_is_in_it() -> None:
    assert model_schema()["properties"]["effects"]["items"]["properties"]["id"]["enum"] == list(EFFECTS)


def test_a_controller_without_gains_is_not_valid() -> None:
    data = tomllib.loads(CONTROLLERS[0].read_text("utf-8"))
    with pytest.raises(jsonschema.ValidationError):
        CONTROLLER.validate(data | {"wsc": {}})
