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


@pytest.mark.parametrize("text", ["", 3, None])
def test_refused(text: object) -> None:
    with pytest.raises(BadInputError, match="text"):
        step_of("operator_prompt", text=text)
