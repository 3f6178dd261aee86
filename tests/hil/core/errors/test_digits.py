"""Shares and multiples have the digits that mean something."""

import math

import pytest

from hil.core.errors.wording import factor, multiple, quantity, share


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.123, "12.3 %"),
        (1.0, "100.0 %"),
        (-0.05, "-5.0 %"),
        (0.0, "0.0 %"),
        (-0.0, "0.0 %"),
        (10.0, "1000.0 %"),
        (10.1, "1010 %"),
        (-63.279, "-6330 %"),
        (-19.0, "-1900 %"),
        (-134.6, "-13500 %"),
        (395298220.8561, "> 100000 %"),
        (-40002446658.068, "< -100000 %"),
        (math.inf, "> 100000 %"),
        (math.nan, "-"),
        (0.00004, "0.004 %"),
        (-0.0004, "-0.04 %"),
        (1e-9, "1e-07 %"),
        (-1e-9, "-1e-07 %"),
    ],
)
def test_a_share_is_a_percentage(value: float, text: str) -> None:
    assert share(value) == text


@pytest.mark.parametrize(
    ("value", "text"), [(0.7338, "73.38 %"), (0.0217, "2.17 %"), (0.000217, "0.0217 %"), (0.0, "0.00 %")]
)
def test_a_gap_near_its_noise_keeps_three_digits(value: float, text: str) -> None:
    assert share(value, 2, digits=3) == text


def test_a_change_has_its_sign() -> None:
    assert share(0.02, signed=True) == "+2.0 %"
    assert share(-0.02, signed=True) == "-2.0 %"
    assert share(0.0, signed=True) == "0.0 %"
    assert share(40.0, signed=True) == "+4000 %"


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (1.05, "1.05"),
        (15.0, "15"),
        (0.0, "0"),
        (999.4, "999"),
        (999.6, "> 1000"),
        (3392320.78, "> 1000"),
        (2.9e19, "> 1000"),
        (math.inf, "> 1000"),
        (1e-5, "< 0.001"),
        (math.nan, "-"),
    ],
)
def test_a_multiple_has_three_digits(value: float, text: str) -> None:
    assert factor(value) == text
    assert multiple(value) == f"{text} times"


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (12.345, "12.3 N m"),
        (6104.4, "6104 N m"),
        (0.0, "0 N m"),
        (-0.01234, "-0.0123 N m"),
        (3.92e-9, "3.92e-09 N m"),
        (2.9e19, "2.90e+19 N m"),
        (math.nan, "- N m"),
    ],
)
def test_a_quantity_has_three_digits_and_its_unit(value: float, text: str) -> None:
    assert quantity(value, "N m") == text
    assert quantity(value, "") == text.removesuffix(" N m")
