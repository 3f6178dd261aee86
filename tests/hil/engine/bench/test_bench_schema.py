"""The schema of bench files: shipped benches are valid, what the reader refuses is not."""

from __future__ import annotations

import datetime
import json
import tomllib
from typing import Any

import jsonschema
import pytest

from hil.engine.bench.bench_file import bench_schema, shipped, shipped_benches
from tests.benches_for_tests import SIM

SCHEMA = bench_schema()
VALIDATOR = jsonschema.Draft202012Validator(SCHEMA)
BENCH = tomllib.loads(SIM.text)


def as_json(data: dict[str, Any]) -> Any:
    """Dates as editors' TOML readers give them."""
    return json.loads(json.dumps(data, default=datetime.date.isoformat))


def test_it_is_a_schema() -> None:
    jsonschema.Draft202012Validator.check_schema(SCHEMA)


@pytest.mark.parametrize("name", shipped_benches())
def test_shipped_benches_are_valid(name) -> None:
    VALIDATOR.validate(as_json(tomllib.loads(shipped(f"{name}.toml").read_text("utf-8"))))


@pytest.mark.parametrize(
    "change",
    [
        {"titel": ""},
        {"text": ""},
        {"limits": {}},
        {"limits": BENCH["limits"] | {"shaft_torque_nm": -1.0}},
        {"rmcu": {"bus": "rmcu"}},
        {"rmcu": BENCH["rmcu"] | {"dcb": "x"}},
        {"rmcu": BENCH["rmcu"] | {"kind": "abacus"}},
        {"dyno": BENCH["dyno"] | {"rear_left": "three"}},
        {"devices": {"oil": {"port": 1}}},
        {"calibration": {"wheel_speed": 2027}},
        {"vehicle": {"slip": 1.0}},
    ],
    ids=str,
)
def test_what_a_bench_may_not_have_is_not_valid(change: dict[str, Any]) -> None:
    VALIDATOR.validate(BENCH)
    with pytest.raises(jsonschema.ValidationError):
        VALIDATOR.validate(BENCH | change)
