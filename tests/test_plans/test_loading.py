from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hil.core.errors import BadInputError
from test_plans import METRICS, STEPS, library_plans, load_plan, plan_from_text
from test_plans.plan import PlanKeys
from tests.test_plans.writing import STEP, plan_of, text_of

ACCEPTANCE = load_plan("acceptance").text


def refused(text: str) -> str:
    with pytest.raises(BadInputError) as caught:
        plan_from_text(text, "plan.yaml", Path())
    return str(caught.value)


def test_a_built_in_plan_by_name_and_by_path() -> None:
    by_name = load_plan("acceptance")
    assert by_name.name == "acceptance"
    assert by_name.text == by_name.source.read_text(encoding="utf-8")
    assert load_plan(by_name.source) == by_name
    assert load_plan(str(by_name.source)) == by_name


def test_a_file_without_suffix_goes_before_a_built_in_plan(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "acceptance").write_text("name: mine\nsteps: [wait: {duration_s: 1}]")
    monkeypatch.chdir(tmp_path)
    assert load_plan("acceptance").name == "mine"


@pytest.mark.parametrize("name", ["acceptence", "", "a\0b", "x" * 5000])
def test_an_unknown_name_lists_the_known_ones(name: str) -> None:
    with pytest.raises(BadInputError) as caught:
        load_plan(name)
    assert "acceptance" in str(caught.value)
    assert len(str(caught.value)) < 500


def test_unreadable_files(tmp_path: Path) -> None:
    for path in (tmp_path / "missing.yaml", tmp_path):
        with pytest.raises(BadInputError) as caught:
            load_plan(path)
        assert str(tmp_path) in str(caught.value)
    (tmp_path / "latin.yaml").write_bytes(b"name: \xe9")
    with pytest.raises(BadInputError, match="UTF-8"):
        load_plan(tmp_path / "latin.yaml")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "plan.yaml: line 1: nothing is given where"),
        ("- a", "plan.yaml: line 1: a list is given where"),
        ("name: p", "at least one step"),
        ("name: p\nsteps: []", "line 2, key 'steps': a plan needs at least one step"),
        ("name: p\nsteps: 3", "line 2, key 'steps': 3 is given where a list is needed"),
        ("name: p\nstep: []", "line 2, key 'step': unknown key 'step'\n  did you mean 'steps'?"),
        ("name: p q\nsteps: [wait: {duration_s: 1}]", "line 1, key 'name'"),
        ("steps: [wait: {duration_s: 1}]", "the key 'name' is missing"),
        ("name: p\nsteps: [wait]", "line 2, key 'steps[1]': 'wait' is given where"),
        ("name: p\nsteps: [{wait: {}, coast: {}}]", "a step has one key, its kind; this has 2"),
        ("name: p\nsteps:\n - wait:\n   duration_s: 1", "indent the step's own keys"),
        (
            "name: p\nsteps: [wiat: {}]",
            "key 'steps[1].wiat': unknown kind of step 'wiat'\n  did you mean 'wait'",
        ),
        ("name: p\nsteps: [wait: 3]", "key 'steps[1].wait': 3 is given where keys"),
        ("name: p\nsteps: [wait: ]", "the key 'duration_s' is missing\n  duration_s: time to wait, s"),
        ("name: p\nsteps: [wait: {duration_s: -1}]", "-1 must be at least 0"),
        ("name: p\nsteps: [wait: {duration_s: '1'}]", "'1' must be a number"),
        ("name: p\nsteps: [wait: {duration_s: .nan}]", "nan must be a finite number"),
        ("name: p\nsteps: [wait: {duration_s: true}]", "True must be a number"),
        (
            "name: p\nsteps:\n - repeat:\n    times: 2\n    steps:\n     - wait: {durations: 1}",
            "line 6, key 'steps[1].repeat.steps[1].wait.durations': unknown key 'durations'\n  did you mean",
        ),
        ("name: p\nsteps: [repeat: {times: 2}]", "the key 'steps' is missing"),
        ("name: p\nsteps: [wait: {duration_s: 1}]\nfinally: 0", "line 3, key 'finally': 0 is given where"),
        ("name: p\nsteps: [wait: {duration_s: 1}]\ncriteria: no", "key 'criteria': 'no' is given where"),
    ],
)
def test_messages_name_line_and_key(text: str, says: str) -> None:
    assert says in refused(text)


def test_segments_have_names_of_their_own() -> None:
    assert "key 'steps[2]': two steps produce a segment 'up'" in refused(
        text_of({"step": STEP}, {"step": STEP})
    )


def test_the_end_is_for_coming_to_rest() -> None:
    text = text_of({"wait": {"duration_s": 1}}, **{"finally": [{"step": STEP}]})
    assert "key 'finally[1]': the segment 'up' is not evaluated" in refused(text)


def test_a_plan_is_not_longer_than_a_day() -> None:
    text = text_of({"repeat": {"times": 30, "steps": [{"wait": {"duration_s": 3600}}]}})
    assert "would take 30.0 h" in refused(text)


def test_criteria_have_ids_of_their_own() -> None:
    peak = {"segment": "up", "metric": "peak_shaft_torque"}
    assert "key 'criteria[2]': the criterion 'up.peak_shaft_torque' occurs twice" in refused(
        text_of({"step": STEP}, criteria=[peak, peak])
    )
    plan = plan_of({"step": STEP}, criteria=[peak, peak | {"id": "again", "to_s": 2}])
    assert [criterion.id for criterion in plan.criteria] == ["up.peak_shaft_torque", "again"]


def test_a_controller_beside_the_plan_goes_before_a_built_in_one(tmp_path: Path) -> None:
    name = "phase_stabilization.toml"
    text = f"name: p\nsteps: [set_controller: {{file: {name}}}]"
    built_in = plan_from_text(text, "p.yaml", tmp_path).steps[0].model_dump()["file"]
    assert built_in.parent.name == "controllers"
    (tmp_path / name).write_text(built_in.read_text())
    assert plan_from_text(text, "p.yaml", tmp_path).steps[0].model_dump()["file"] == tmp_path / name


def test_controller_files_that_cannot_be_used(tmp_path: Path) -> None:
    (tmp_path / "broken.toml").write_text("name = 'x'\ntorque_limit_nm = -1")
    for file, says in (
        ("missing.toml", "no such file"),
        ("broken.toml", "broken.toml"),
        ("a\0b", "no such file"),
    ):
        text = text_of({"set_controller": {"file": file}})
        with pytest.raises(BadInputError) as caught:
            plan_from_text(text, "p.yaml", tmp_path)
        assert "p.yaml: line 1, key 'steps[1].set_controller.file'" in str(caught.value)
        assert says in str(caught.value)


def test_a_plan_of_the_past_needs_no_controller_files() -> None:
    text = text_of({"set_controller": {"file": "gone.toml"}})
    plan = plan_from_text(text, "p.yaml", Path(), files_required=False)
    assert plan.steps[0].model_dump()["file"] == Path("gone.toml")


_WORDS = st.sampled_from(
    [
        *STEPS.names(),
        *METRICS.names(),
        *PlanKeys.model_fields,
        *STEP,
        *("steps", "finally", "criteria", "metric", "upper", "below", "unit", "times", "levels_nm", "hold_s"),
        *("duration_s", "text", "file", "to_hz", "from_hz", "period_s", "periods", "seed", "speed_km_h"),
        *("vehicle", "speed", "driving_torque", "motor_torque", "up", "shaft_torque_nm", "logarithmic"),
    ]
)
_LEAVES = st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5) | _WORDS
_VALUES = st.recursive(
    _LEAVES, lambda inner: st.lists(inner, max_size=4) | st.dictionaries(_WORDS, inner), max_leaves=25
)
_STEPS = st.dictionaries(
    st.sampled_from(STEPS.names()), st.dictionaries(_WORDS, _VALUES), min_size=1, max_size=1
)
_NEARLY_PLANS = st.fixed_dictionaries(
    {"name": _WORDS | _LEAVES, "steps": st.lists(_STEPS | _VALUES, max_size=3)},
    optional={"finally": _VALUES, "criteria": st.lists(st.dictionaries(_WORDS, _VALUES)) | _VALUES},
)


def read_or_refused(text: str) -> None:
    message = "p.yaml"
    try:
        plan_from_text(text, "p.yaml", Path("nowhere"))
    except BadInputError as error:
        message = str(error)
    assert message.startswith("p.yaml")


@pytest.mark.slow
@given(_NEARLY_PLANS | _VALUES)
@settings(max_examples=300)
def test_whatever_the_values_a_plan_is_read_or_refused(value: object) -> None:
    read_or_refused(json.dumps(value).replace("NaN", ".nan").replace("Infinity", ".inf"))


@given(st.integers(0, len(ACCEPTANCE)), st.integers(0, 40), st.text(max_size=10))
@settings(max_examples=200)
def test_a_damaged_plan_is_read_or_refused(start: int, removed: int, inserted: str) -> None:
    read_or_refused(ACCEPTANCE[:start] + inserted + ACCEPTANCE[start + removed :])


@given(
    st.dictionaries(_WORDS, st.floats() | st.integers(), max_size=3), st.sampled_from(["chirp", "multisine"])
)
@settings(max_examples=200)
def test_a_stimulus_with_odd_numbers_is_read_or_refused(changes: dict[str, float], kind: str) -> None:
    keys = {"segment": "s", "quantity": "motor_torque", "from_hz": 1, "to_hz": 20}
    own = {
        "chirp": {"duration_s": 10, "amplitude_nm": 5},
        "multisine": {"seed": 1, "period_s": 2, "periods": 3, "rms_nm": 4},
    }
    text = text_of({kind: keys | own[kind] | changes})
    read_or_refused(text.replace("NaN", ".nan").replace("Infinity", ".inf"))


def test_built_in_plans() -> None:
    assert library_plans() == (
        "abs_release",
        "acceptance",
        "commissioning",
        "driveability",
        "identification",
        "short_identification",
        "slip",
        "split_friction",
        "take_off_on_low_friction",
    )


DRIVING = "ramp: {quantity: driving_torque, from_nm: 0, to_nm: 100, duration_s: 0.2}"
LOADED = "set_controller: {file: phase_stabilization.toml}"


@pytest.mark.parametrize(
    ("steps", "end", "line"),
    [
        (f"[{{{DRIVING}}}]", "[]", "line 2"),
        (
            f"[{{repeat: {{times: 2, steps: [{{wait: {{duration_s: 1}}}}, {{{DRIVING}}}]}}}}, {{{LOADED}}}]",
            "[]",
            "line 2",
        ),
        ("[{wait: {duration_s: 1}}]", f"[{{{DRIVING}}}]", "line 3"),
    ],
)
def test_driving_torque_before_any_controller_is_refused_where_it_stands(
    steps: str, end: str, line: str
) -> None:
    with pytest.raises(BadInputError, match="requests driving torque before any set_controller") as caught:
        plan_from_text(f"name: x\nsteps: {steps}\nfinally: {end}\n", "p.yaml", Path(), to_execute=True)
    assert line in caught.value.where
    assert "set_controller: {file:" in caught.value.fix


@pytest.mark.parametrize(
    "steps",
    [
        f"[{{{LOADED}}}, {{{DRIVING}}}]",
        f"[{{repeat: {{times: 2, steps: [{{{LOADED}}}, {{{DRIVING}}}]}}}}, {{{DRIVING}}}]",
        f"[{{{DRIVING.replace('driving', 'motor')}}}, {{{LOADED}}}, {{{DRIVING}}}]",
    ],
)
def test_a_controller_that_comes_before_is_enough(steps: str) -> None:
    assert plan_from_text(f"name: x\nsteps: {steps}\n", "p.yaml", Path(), to_execute=True).steps


def test_a_plan_has_no_more_steps_than_repeat_allows() -> None:
    step = "\n  - wait: {duration_s: 0.1}"
    with pytest.raises(BadInputError, match="line 2, key 'steps': 10001 steps in total, at most 10000"):
        plan_from_text(f"name: p\nsteps:{step * 10_001}", "p.yaml", Path())


def test_a_file_that_is_no_plan_but_long_is_refused_before_it_is_read(tmp_path: Path) -> None:
    path = tmp_path / "log.yaml"
    path.write_text("# 12:00:01 motor speed 33.1 rad/s\n" * 20_000)
    with pytest.raises(BadInputError, match=r"log\.yaml: has more than 0\.5 MB"):
        load_plan(path)
    with pytest.raises(BadInputError, match=r"x\.yaml: has more than 0\.5 MB"):
        plan_from_text(path.read_text(), "x.yaml", tmp_path)  # as a service is given it
