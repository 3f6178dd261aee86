"""What a user asks for must be there, and be a number that it can be."""

import pytest

from hil.analysis.diagnosis.asked import Asked
from hil.core.channels import OUTPUTS
from hil.core.errors import BadInputError


def test_what_is_asked_is_kept() -> None:
    asked = Asked.checked({OUTPUTS[0]: 0.01}, {"channel_skew": 0.0})
    assert asked == Asked({OUTPUTS[0]: 0.01}, {"channel_skew": 0.0})


@pytest.mark.parametrize("least", [{"skew": 1.0}, {"channel_skew": -1.0}, {"channel_skew": float("nan")}])
def test_sizes_that_are_none_are_refused(least: dict[str, float]) -> None:
    with pytest.raises(BadInputError, match="least"):
        Asked.checked({}, least)


@pytest.mark.parametrize("noise", [{"oil_temperature": 1.0}, {OUTPUTS[0]: -1.0}, {OUTPUTS[0]: float("inf")}])
def test_noise_that_is_none_is_refused(noise: dict[str, float]) -> None:
    with pytest.raises(BadInputError, match="noise"):
        Asked.checked(noise, {})
