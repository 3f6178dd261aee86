from __future__ import annotations

import pytest
from pydantic import Field

from hil.core.errors import BadInputError
from test_plans.building import Strict, brief, build, key_names
from test_plans.yaml_document import read_yaml


class Horn(Strict):
    loud_s: float = Field(alias="duration_s", gt=0, description="how long, s")
    tone: str = "low"


DOCUMENT = read_yaml("horn:\n  duration_s: 0\n  ton: high\n", "p.yaml")


def test_an_unknown_key_is_told_before_a_wrong_value() -> None:
    with pytest.raises(BadInputError) as caught:
        build(Horn, {"duration_s": 0, "ton": "high"}, DOCUMENT, ("horn",))
    assert str(caught.value).splitlines() == [
        "p.yaml: 2 mistakes",
        "  line 3, key 'horn.ton': unknown key 'ton'; did you mean 'tone'? known: duration_s, tone",
        "  line 2, key 'horn.duration_s': 0 must be more than 0; duration_s: how long, s",
    ]


def test_of_very_many_mistakes_as_many_are_told_as_somebody_reads() -> None:
    keys = [f"unknown_{number}" for number in range(200)]
    text = "horn:\n  duration_s: 1\n" + "".join(f"  {key}: 1\n" for key in keys)
    document = read_yaml(text, "p.yaml")
    with pytest.raises(BadInputError) as caught:
        build(Horn, {"duration_s": 1, **dict.fromkeys(keys, 1)}, document, ("horn",))
    head, first, *_, last = str(caught.value).splitlines()
    assert head == "p.yaml: 200 mistakes"
    assert first.startswith("  line 3, key 'horn.unknown_0'")
    assert last.endswith(" more, when these are corrected")
    assert len(str(caught.value)) < 5000


def test_a_wrong_value_is_shown_with_the_keys_meaning() -> None:
    with pytest.raises(BadInputError) as caught:
        build(Horn, {"duration_s": 0}, DOCUMENT, ("horn",))
    assert str(caught.value) == (
        "p.yaml: line 2, key 'horn.duration_s': 0 must be more than 0\n  duration_s: how long, s"
    )


def test_keys_are_named_as_in_yaml() -> None:
    assert key_names(Horn) == ["duration_s", "tone"]


def test_values_are_shown_on_one_short_line() -> None:
    assert brief({"a": 1}) == "a mapping"
    assert brief([1]) == "a list"
    assert brief(None) == "nothing"
    assert len(brief("x" * 1000)) == 60
    assert "\n" not in brief("a\nb")
