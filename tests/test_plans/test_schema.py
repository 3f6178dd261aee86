from __future__ import annotations

from typing import Any

import jsonschema
import pytest

from test_plans import METRICS, STEPS, library_plans, load_plan, plan_schema
from test_plans.yaml_document import read_yaml
from tests.test_plans.writing import STEP

SCHEMA = plan_schema()
VALIDATOR = jsonschema.Draft202012Validator(SCHEMA)
PLAN: dict[str, Any] = {
    "name": "p",
    "steps": [{"step": STEP}],
    "criteria": [{"segment": "up", "metric": "peak_shaft_torque", "upper": 1}],
}


def test_the_schema_is_a_schema() -> None:
    jsonschema.Draft202012Validator.check_schema(SCHEMA)


@pytest.mark.parametrize("name", library_plans())
def test_built_in_plans_are_valid(name: str) -> None:
    VALIDATOR.validate(read_yaml(load_plan(name).text, name).value)


@pytest.mark.parametrize(
    "change",
    [
        {"stepps": []},
        {"steps": []},
        {"steps": [{"stepp": STEP}]},
        {"steps": [{"step": STEP | {"from": 1}}]},
        {"steps": [{"step": STEP | {"from_nm": "1"}}]},
        {"steps": [{"step": STEP | {"quantity": "torque"}}]},
        {"steps": [{"step": STEP, "wait": {"duration_s": 1}}]},
        {"steps": [{"repeat": {"times": 2, "steps": [{"wait": {"seconds": 1}}]}}]},
        {"finally": [{"ramp_down": {}}]},
        {"criteria": [{"segment": "up", "metric": "peak_shaft_torque", "uper": 1}]},
        {"criteria": [{"segment": "up", "metric": "peak_shaft_torque", "from_hz": 1}]},
        {"criteria": [{"segment": "up", "metric": "peek"}]},
        {"criteria": [{"segment": "up", "metric": "peak"}]},
        {"criteria": [{"segment": "up", "metric": "peak", "channel": "speed"}]},
    ],
)
def test_what_a_plan_may_not_have_is_not_valid(change: dict[str, Any]) -> None:
    VALIDATOR.validate(PLAN)
    with pytest.raises(jsonschema.ValidationError):
        VALIDATOR.validate(PLAN | change)


def test_every_kind_and_metric_is_in_it() -> None:
    definitions = SCHEMA["$defs"]
    assert set(definitions["step"]["properties"]) == set(STEPS.names())
    assert set(definitions["criterion"]["properties"]["metric"]["enum"]) == set(METRICS.names())


def test_keys_explain_themselves() -> None:
    for kind, schema in SCHEMA["$defs"]["step"]["properties"].items():
        for key, value in schema["properties"].items():
            assert value.get("description"), f"{kind}.{key}"
