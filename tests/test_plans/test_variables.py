"""Variables of a plan: what stands for them, what may be chosen, and that the plan's text says what was."""

from __future__ import annotations

import copy
from pathlib import Path

import jsonschema
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil.core.errors import BadInputError
from test_plans import Choices, Plan, load_plan, plan_from_text, plan_schema
from test_plans.steps import Repeat, TorqueStep
from test_plans.yaml_document import read_yaml

TEXT = """
name: tip
title: Step to ${torque_nm} N m, ${times} times   # größer
variables:
  torque_nm: {default: 250, unit: N m, lower: -100, upper: 300.5}
  times: {default: 2}   # a whole number
  limit_nm: {default: 4.5e2}
steps:
  - repeat:
      times: $times
      steps:
        - step: {segment: s, quantity: motor_torque, from_nm: 0, to_nm: $torque_nm, before_s: 0, after_s: 2}
criteria:
  - {segment: s_1, metric: magnitude, channel: shaft_torque_nm, upper: "${limit_nm}", unit: N m}
"""


def read(text: str = TEXT) -> Plan:
    return plan_from_text(text, "p.yaml", Path())


def chosen(tmp_path: Path, **values: float) -> Plan:
    (tmp_path / "p.yaml").write_text(TEXT, "utf-8")
    return load_plan(tmp_path / "p.yaml", Choices(values=values))


def step(plan: Plan) -> tuple[int, float]:
    repeat = plan.steps[0]
    assert isinstance(repeat, Repeat)
    inner = repeat.steps[0]
    assert isinstance(inner, TorqueStep)
    return repeat.times, inner.to_nm


def refused(text: str) -> str:
    with pytest.raises(BadInputError) as caught:
        read(text)
    return str(caught.value)


def test_names_stand_for_the_defaults_also_in_texts() -> None:
    plan = read()
    assert step(plan) == (2, 250)
    assert plan.title == "Step to 250 N m, 2 times"
    assert plan.criteria[0].upper == 450
    assert [str(value) for value in plan.values] == ["torque_nm = 250 N m", "times = 2", "limit_nm = 450"]


def test_what_is_chosen_stands_in_the_text_and_nothing_else_changes(tmp_path) -> None:
    plan = chosen(tmp_path, torque_nm=-12.5, times=3)
    assert step(plan) == (3, -12.5)
    assert plan.text == TEXT.replace("default: 250", "default: -12.5").replace("default: 2}", "default: 3}")
    assert read(plan.text).values == plan.values


@given(st.floats(-100, 300.5, allow_nan=False))
def test_every_value_within_the_bounds_is_what_the_step_gets(value: float) -> None:
    text = Choices(values={"torque_nm": value}).applied(TEXT, read_yaml(TEXT, "p.yaml"))
    plan = read(text) if value != 0 else None
    assert plan is None or step(plan)[1] == value


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"torque_nm": 301.0}, "301 N m is above the largest allowed value, 300.5 N m"),
        ({"torque_nm": -101.0}, "-101 N m is below the smallest"),
        ({"torque": 1.0}, "has no variable 'torque'\n  did you mean 'torque_nm'?"),
        ({"times": 2.5}, "2.5 must be a whole number"),
    ],
)
def test_what_may_not_be_chosen_is_refused(values, said, tmp_path) -> None:
    with pytest.raises(BadInputError) as caught:
        chosen(tmp_path, **values)
    assert said in str(caught.value)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            "$torque_nm,",
            "$torque,",
            "line 12, key 'steps[1].repeat.steps[1].step.to_nm': there is no",
        ),
        ("${times} times", "${tmes}", "key 'title': there is no variable 'tmes'\n  did you mean 'times'?"),
        ("default: 250,", "", "the key 'default' is missing"),
        ("default: 250", "default: 999", "default = 999 N m is above the largest"),
        ("default: 250", "default: much", "key 'variables.torque_nm.default'"),
        ("lower: -100", "least: -100", "unknown key 'least'"),
        (
            "variables:\n",
            "variables:\n  2nd: {default: 1}\n",
            "key 'variables.2nd': '2nd' is not a valid name",
        ),
    ],
)
def test_mistakes_are_told_with_their_place(old, new, said) -> None:
    assert old in TEXT
    assert said in refused(TEXT.replace(old, new))


def test_plans_without_variables_may_have_dollars() -> None:
    text = "name: p\ntitle: costs $5 or ${x}\nsteps: [wait: {duration_s: 1}]"
    assert read(text).title == "costs $5 or ${x}"


def test_the_schema_knows_variables() -> None:
    validator = jsonschema.Draft202012Validator(plan_schema())
    content = read_yaml(TEXT, "p.yaml").value
    validator.validate(content)
    wrong = copy.deepcopy(content)
    assert isinstance(wrong, dict)
    wrong["variables"]["torque_nm"]["least"] = 1
    with pytest.raises(jsonschema.ValidationError):
        validator.validate(wrong)
