from __future__ import annotations

import pytest

from hil.core.errors import BadInputError
from test_plans.loading import LIBRARY
from tests.test_plans.note_taker import NoteTaker
from tests.test_plans.writing import step_of


def test_the_file_that_was_found_goes_to_the_conductor() -> None:
    conductor = NoteTaker()
    step = step_of("set_controller", file="gain_stabilization.toml")
    step.execute(conductor)
    assert conductor.calls == [("set_controller", LIBRARY / "controllers" / "gain_stabilization.toml")]
    assert step.duration_s == 0.0


@pytest.mark.parametrize("file", ["missing.toml", 3, None, ".", "x" * 5000])
def test_refused(file: object) -> None:
    with pytest.raises(BadInputError, match=r"set_controller"):
        step_of("set_controller", file=file)
