"""What pydantic finds is stated in the bench's own words."""

from typing import Literal

import pytest
from pydantic import BaseModel, Field, ValidationError

from hil.core.errors.mistakes import needed


class Table(BaseModel, strict=True, allow_inf_nan=False):
    node: int = Field(3, ge=1, le=127)
    torque_nm: float = Field(1.0, gt=0, lt=1e6)
    name: str = Field("x", min_length=1, max_length=3)
    side: Literal["left", "right"] = "left"
    on: bool = True
    nodes: dict[str, int] = {}


@pytest.mark.parametrize(
    ("value", "said"),
    [
        ({"node": 300}, "must be at most 127"),
        ({"node": 0}, "must be at least 1"),
        ({"node": 1.5}, "must be a whole number"),
        ({"torque_nm": 0.0}, "must be more than 0"),
        ({"torque_nm": 2e6}, "must be less than 1e+06"),
        ({"torque_nm": float("nan")}, "must be a finite number"),
        ({"torque_nm": "5"}, "must be a number"),
        ({"name": ""}, "must not be empty"),
        ({"name": "long"}, "must have at most 3 characters"),
        ({"side": "up"}, "must be 'left' or 'right'"),
        ({"on": "yes"}, "must be true or false"),
        ({"nodes": [1]}, "must be a table"),
    ],
)
def test_in_words(value: dict[str, object], said: str) -> None:
    with pytest.raises(ValidationError) as caught:
        Table.model_validate(value)
    assert [needed(mistake) for mistake in caught.value.errors()] == [said]
