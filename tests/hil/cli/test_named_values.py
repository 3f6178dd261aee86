"""Options of the form NAME=VALUE."""

import pytest

from hil.cli.inputs import named_numbers, named_values
from hil.cli.run_inputs import choices_of
from hil.core.errors import BadInputError


def test_names_and_numbers() -> None:
    assert named_numbers(["a=1e-3", " b = 2"], "--least") == {"a": 1e-3, "b": 2.0}


@pytest.mark.parametrize("text", ["a", "a=", "a=x", "", "a=1_00", "a=inf", "a=nan", "a=1e999", "a=\u0661"])
def test_what_is_no_number_is_refused_with_the_option(text: str) -> None:
    with pytest.raises(BadInputError, match="--least"):
        named_numbers([text], "--least")


def test_values_keep_their_text_and_a_name_given_twice_is_refused() -> None:
    assert named_values(["a.channel = speed", "b=="], "--hide") == {"a.channel": "speed", "b": "="}
    with pytest.raises(BadInputError, match=r"'a\.channel' is given twice"):
        named_values(["a.channel=speed", "b=1", "a.channel = torque"], "--hide")
    with pytest.raises(BadInputError, match="EFFECT=VALUE"):
        named_values(["backlash"], "--hide", form="EFFECT=VALUE")


@pytest.mark.parametrize("text", ["1_00", "inf", "0x10", "1,5x", "\u0663"])
def test_a_value_that_a_plan_would_take_for_text_is_refused_with_its_variable(text: str) -> None:
    with pytest.raises(BadInputError, match="tq = "):
        choices_of([f"tq={text}"], None)
    assert choices_of(["tq=-1.5e2"], None).values == {"tq": -150.0}
