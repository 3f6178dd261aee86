from __future__ import annotations

import json
import math

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from hil.core.errors import BadInputError
from test_plans.yaml_document import read_yaml

LEAVES = (
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text()
)
VALUES = st.recursive(
    LEAVES, lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner), max_leaves=20
)


def test_values_are_those_of_yaml_1_2() -> None:
    text = "{a: 1e3, b: 1:30, c: off, d: 010, e: -.5, f: 'true', g: true, h: , i: 2026-01-01, j: -.inf}"
    assert read_yaml(text, "p").value == {
        "a": 1000.0,
        "b": "1:30",
        "c": "off",
        "d": 10,
        "e": -0.5,
        "f": "true",
        "g": True,
        "h": None,
        "i": "2026-01-01",
        "j": -math.inf,
    }


def test_places() -> None:
    document = read_yaml("name: a\nsteps:\n  - wait:\n      duration_s: 1\n", "p.yaml")
    assert document.place(("steps", 0, "wait", "duration_s")) == (
        "p.yaml: line 4, key 'steps[1].wait.duration_s'"
    )
    assert document.place(("steps", 0, "wait", "missing")).startswith("p.yaml: line 3,")
    assert document.place(()) == "p.yaml: line 1"


@pytest.mark.parametrize(
    ("text", "line", "says"),
    [
        ("a: 1\na: 2", 2, "twice, first in line 1"),
        ("a: {b: 1,\n c: 2,\n b: 3}", 3, "twice, first in line 1"),
        ("a: &x 1\nb: *x", 2, "aliases"),
        ("a: 1\nb: !!python/object:os.system ls", 2, "tags"),
        ("a: !!map {}", 1, "tags"),
        ("a: [1,\nb: 2", 2, "not YAML"),
        ("a: 1\n---\nb: 2", 2, "not YAML"),
        ("? [a]\n: b", 1, "a key must be a text"),
        ('a: 1\nb: "\\ud800"', 2, "surrogate"),
    ],
)
def test_refused_with_the_line(text: str, line: int, says: str) -> None:
    with pytest.raises(BadInputError) as caught:
        read_yaml(text, "p.yaml")
    assert f"p.yaml: line {line}" in str(caught.value)
    assert says in str(caught.value)


def test_nesting_has_an_end() -> None:
    with pytest.raises(BadInputError, match="nested too deeply"):
        read_yaml("[" * 20_000, "p.yaml")


@given(st.text())
@example('a: "\\U99999999"')
@example("%YAML 9" + "9" * 5000 + ".1\n---\na")
@example("a: " + "9" * 5000)
def test_any_text_is_read_or_refused(text: str) -> None:
    message = "p.yaml"
    try:
        read_yaml(text, "p.yaml")
    except BadInputError as error:
        message = str(error)
    assert message.startswith("p.yaml")


@given(VALUES)
def test_json_is_read_as_json_reads_it(value: object) -> None:
    assert read_yaml(json.dumps(value), "p.yaml").value == value
