from __future__ import annotations

import math
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil.core.errors.wording import share as plain_share
from reports import labels


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (357.123, "357.1"),
        (0.0213456, "0.02135"),
        (12345.6, "12\u202f346"),
        (-4.5678, "−4.568"),
        (0.0, "0"),
        (2.5e-7, "2.500\u202f×\u202f10⁻⁷"),
        (None, "–"),
        (math.nan, "–"),
        (-math.inf, "−∞"),
    ],
)
def test_numbers_have_four_digits_and_a_true_minus(value: float | None, text: str) -> None:
    assert labels.number(value) == text


def test_rounding_leaves_no_negative_zero() -> None:
    assert labels.number(-0.0004, decimals=2) == "0.00"


@pytest.mark.parametrize(
    ("value", "text"), [(564.0, "564"), (2.6775, "2.6775"), (0.001, "0.001"), (20, "20")]
)
def test_a_chosen_number_gains_no_digits(value: float, text: str) -> None:
    assert labels.nominal(value) == text


def test_a_quantity_keeps_number_and_unit_together() -> None:
    assert labels.quantity(357.1, "N m") == "357.1\u202fN\u202fm"
    assert labels.quantity(0.95, "1") == "0.9500"


def test_file_sizes() -> None:
    assert labels.file_size(54) == "54\u202fB"
    assert labels.file_size(41_300_000) == "41.30\u202fMB"


@pytest.mark.parametrize(("share", "said"), [(0.001, "<1%"), (0.26, "26%"), (0.99, "99%"), (0.995, ">99%")])
def test_nothing_is_quite_certain(share, said):
    assert labels.chance(share) == said


@pytest.mark.parametrize(
    ("share", "text"),
    [
        (0.123, "12.3\u202f%"),
        (-63.279, "−6330\u202f%"),
        (-5.3e-7, "−5\u202f×\u202f10⁻⁵\u202f%"),
        (None, "–"),
        (math.nan, "–"),
    ],
)
def test_shares_are_set_with_thin_spaces_and_a_true_minus(share: float | None, text: str) -> None:
    assert labels.share(share) == text


def test_a_factor_has_digits_that_mean_something() -> None:
    assert labels.factor(1.0512) == "1.05"
    assert labels.factor(3392320.78) == ">\u202f1000"
    assert labels.factor(None) == "–"


@given(st.floats(1e-9, 1e3))
def test_a_share_is_the_same_number_in_a_report_and_on_the_command_line(share: float) -> None:
    """Zeros behind a decimal point are no thousands: 0.00719 % was 0.719 %."""
    set_, plain = labels.share(share, 2, digits=3), plain_share(share, 2, digits=3)
    assert "".join(set_.split()).replace("×10", "e").translate(_SUPERSCRIPTS) == _as_set(
        "".join(plain.split())
    )


def _as_set(plain: str) -> str:
    """The exponent without its leading zero."""
    return re.sub(r"e-0?(\d+)", r"e-\1", plain)


_SUPERSCRIPTS = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹−", "-0123456789-")
