"""Campaign files: what they say; every mistake is told with line, key and what would be right."""

from pathlib import Path

import jsonschema
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from hil.analysis.campaigns import (
    MOST_VALUES,
    axes_of,
    campaign_from_text,
    campaign_schema,
    controller_file,
    library_campaigns,
    load_campaign_file,
)
from hil.core.effects import EFFECTS
from hil.core.errors import BadInputError
from test_plans import load_plan
from tests.hil.analysis.tuning.trials import MODEL

HEAD = "name: mine\nplan: acceptance\n"


def read(text):
    return campaign_from_text(HEAD + text, Path("mine.yaml"))


def axes(text, plan="acceptance", *, controlled=True):
    return axes_of(read(text), load_plan(plan), MODEL, controlled=controlled)


def test_lists_and_ranges_become_values():
    file = read(
        "vary:\n  model.vehicle_inertia: {from: 200, to: 400, count: 3}\n"
        "  effect.backlash.half_gap_rad: {from: 0.001, to: 0.1, count: 3, scale: log}\n"
        "  controller.lead_deg: [20, 36.5]\n"
    )
    assert file.vary["model.vehicle_inertia"] == (200.0, 300.0, 400.0)
    assert file.vary["effect.backlash.half_gap_rad"] == pytest.approx((0.001, 0.01, 0.1), rel=1e-11)
    assert file.vary["controller.lead_deg"] == (20.0, 36.5)


def test_the_shipped_ones_can_be_read():
    for name in library_campaigns():
        assert load_campaign_file(name).name == name


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("drws: 3\n", "line 3, key 'drws': unknown key 'drws'\n  did you mean 'draws'?"),
        ("format: 2\n", "is of a newer version"),
        ("draws: many\n", "line 3, key 'draws': 'many'"),
        ("pass_share: 99\n", "line 3, key 'pass_share'"),
        ("vary: {model.a: []}\n", "line 3, key 'vary.model.a': there are no values"),
        ("vary: {model.a: [1, 1]}\n", "a value is given twice"),
        ("vary:\n  model.a: [1, x]\n", "line 4, key 'vary.model.a[2]': 'x' is not a number"),
        ("vary: {model.a: {from: 0, to: 1, count: 3, scale: log}}\n", "a logarithm needs values above 0"),
        ("vary: {model.a: {from: 1, to: 2, count: 1}}\n", "key 'vary.model.a.count'"),
        ("tolerance: {tyre_stifness: 0.1}\n", "did you mean 'tyre_stiffness'?"),
        ("tolerance: {tyre_stiffness: 10}\n", "from 0 to below 1: 0.1 for 10 %"),
        ("tolerance:\n  tyre_stiffness: '0.1'\n", "line 4, key 'tolerance.tyre_stiffness': '0.1' is not"),
        ("tolerance: {tyre_stiffness: true}\n", "True is not a half width"),
        ("tolerance: {dead_time_s: '0.1'}\n", "'0.1' must be a number"),
        (
            "vary: {model.a: {from: -1.0e+308, to: 1.0e+308, count: 3}}\n",
            "exceeds the range of numbers, 1.8e308",
        ),
        ("vary: {model.a: {from: 2, to: 2, count: 3}}\n", "3 values from 2 to 2 do not differ"),
        ("drws: 3\nvary: 4\n", "2 mistakes"),
    ],
)
def test_mistakes_are_told_with_line_key_and_what_would_be_right(text, said):
    with pytest.raises(BadInputError) as error:
        read(text)
    assert said in str(error.value)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("vary: {modle.vehicle_inertia: [1]}", "'modle.vehicle_inertia' does not start with a known group"),
        ("vary: {model.vehicle_inerta: [1]}", "did you mean 'vehicle_inertia'?"),
        ("vary: {model.vehicle_inertia: [-1]}", "it must be positive"),
        ("vary: {effect.backlach.half_gap_rad: [1]}", "did you mean 'backlash'?"),
        ("vary: {effect.backlash.half_gap: [1]}", "did you mean 'half_gap_rad'?"),
        ("vary: {effect.backlash.half_gap_rad: [1000]}", "is out of range"),
        ("vary: {controller.lead_deg: [90]}", "controller.lead_deg = 90: give a value from 0 to 85 °"),
        ("vary: {controller.lead_deg: [9], controller.notch_hz: [9]}", "exclude each other"),
        ("vary: {plan.torque_nm: [9]}", "plan 'acceptance' has no variable 'torque_nm'"),
    ],
)
def test_what_there_is_not_and_what_is_out_of_range_is_told(text, said):
    with pytest.raises(BadInputError) as error:
        axes(text)
    assert said in str(error.value)
    assert "mine.yaml: line 3, key 'vary." in str(error.value)


def test_a_controller_that_drives_nothing_is_not_varied():
    with pytest.raises(BadInputError, match="no controller drives"):
        axes("vary: {controller.lead_deg: [9]}", controlled=False)


def test_a_new_effect_may_need_all_of_its_numbers():
    numbers = [p for p in EFFECTS["motor_order_ripple"].parameters if not p.optional]
    assert len(numbers) > 1
    text = "".join(
        f"  effect.motor_order_ripple.{p.name}: [{max(p.lower, min(1.0, p.upper))}]\n" for p in numbers
    )
    assert [axis.unit for axis in axes(f"vary:\n{text}")] == [p.unit for p in numbers]


def test_controllers_are_found_beside_the_file_and_among_the_built_in(tmp_path):
    (tmp_path / "own.toml").write_text("")
    file = campaign_from_text(
        f"{HEAD}controllers: [own.toml, phase_stabilization, ow]", tmp_path / "mine.yaml"
    )
    assert controller_file(file, "own.toml") == tmp_path / "own.toml"
    assert controller_file(file, "phase_stabilization").is_file()
    with pytest.raises(BadInputError, match="there is no controller file 'ow'"):
        controller_file(file, "ow")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("vary: {model.a: [" + "1, " * MOST_VALUES + "2]}\n", "100001 values, at most 100000 are taken"),
        ("draws: 1000\ncontrollers: [a, b]\nvary: {model.a: {from: 1, to: 2, count: 501}}\n",
         "1002000 simulations (1000 cars × 501 values of model.a × 2 controllers), at most 1000000 are made"),
        ("vary:\n" + "".join(f"  model.a{n}: {{from: 1, to: 2, count: 100000}}\n" for n in range(1000)),
         "about 1e5000 simulations"),
    ],
)  # fmt: skip
def test_sizes_are_bounded_before_anything_is_made(text, said):
    with pytest.raises(BadInputError) as error:
        read(text)
    assert said in error.value.what
    assert "line 3" in error.value.where or "line 5" in error.value.where
    assert error.value.fix


@given(st.text(max_size=60))
def test_any_text_is_read_or_refused(text):
    for whole in (text, HEAD + text):
        try:
            campaign_from_text(whole, Path("mine.yaml"))
        except BadInputError as error:
            assert "mine.yaml" in str(error)


def test_the_schema_takes_what_is_read_and_refuses_what_is_not():
    schema = campaign_schema()
    for name in library_campaigns():
        jsonschema.validate(yaml.safe_load(load_campaign_file(name).text), schema)
    for wrong in ("drws: 3", "vary: {a.b: [1]}", "tolerance: {a: 1}", "vary: {model.a: {from: 1}}"):
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate(yaml.safe_load(HEAD + wrong), schema)
