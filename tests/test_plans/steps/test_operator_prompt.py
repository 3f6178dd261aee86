from __future__ import annotations

import pytest

from hil.core.errors import BadInputError
from tests.test_plans.note_taker import NoteTaker
from tests.test_plans.writing import step_of


def test_the_text_is_shown() -> None:
    conductor = NoteTaker()
    step = step_of("operator_prompt", text="Close the door")
    step.execute(conductor)
    assert conductor.calls == [("prompt", "Close the door")]
    assert step.duration_s == 0.0


def test_a_picture_is_shown_with_it() -> None:
    conductor = NoteTaker()
    step_of("operator_prompt", text="Close the door", picture="door-1.png").execute(conductor)
    assert conductor.calls == [("prompt", "Close the door", "door-1.png")]


@pytest.mark.parametrize(
    "name", ["../door.png", "a/door.png", "/door.png", "door.gif", ".png", "door.png\n", 3]
)
def test_a_picture_lies_beside_the_plan_and_is_one_that_browsers_show(name: object) -> None:
    with pytest.raises(BadInputError, match="picture"):
        step_of("operator_prompt", text="Close the door", picture=name)


@pytest.mark.parametrize("text", ["", 3, None])
def test_refused(text: object) -> None:
    with pytest.raises(BadInputError, match="text"):
        step_of("operator_prompt", text=text)
