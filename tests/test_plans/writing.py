"""Short ways to write plans in tests."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from test_plans import Plan, Step, plan_from_text

STEP: dict[str, Any] = {
    "segment": "up",
    "quantity": "driving_torque",
    "from_nm": 0,
    "to_nm": 326,
    "before_s": 1,
    "after_s": 20,
}


def plan_of(*steps: dict[str, Any], **keys: Any) -> Plan:
    return plan_from_text(text_of(*steps, **keys), "plan.yaml", Path())


def text_of(*steps: dict[str, Any], **keys: Any) -> str:
    # JSON is YAML.
    return json.dumps({"name": "p", "steps": steps} | keys)


def step_of(kind: str, **keys: Any) -> Step:
    return plan_of({kind: keys}).steps[0]
