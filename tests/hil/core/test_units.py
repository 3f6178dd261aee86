"""Units of the field against their definitions, and what is refused."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil.core.units import UnitError, conversion, has_unit, is_spelled


@pytest.mark.parametrize(
    ("unit", "wanted", "factor"),
    [
        ("rpm", "rad/s", 2 * math.pi / 60),
        ("1/min", "rad/s", 2 * math.pi / 60),  # of a shaft: DIN
        ("U/min", "rad/s", 2 * math.pi / 60),
        ("min-1", "rad/s", 2 * math.pi / 60),
        ("Hz", "rad/s", 2 * math.pi),
        ("deg/s", "rad/s", math.pi / 180),
        ("Nm", "N m", 1.0),
        ("N·m", "N m", 1.0),
        ("[Nm]", "N m", 1.0),
        ("kNm", "N m", 1e3),
        ("kN m", "N m", 1e3),
        ("mNm", "N m", 1e-3),
        ("MNm", "N m", 1e6),
        ("N mm", "N m", 1e-3),
        ("lbf ft", "N m", 1.3558179483314004),
        ("km/h", "m/s", 1 / 3.6),
        ("mph", "m/s", 0.44704),
        ("ms", "s", 1e-3),
        ("rad/s", "rad/s", 1.0),
    ],
)
def test_a_spelling_of_the_field_is_what_it_means(unit: str, wanted: str, factor: float) -> None:
    found = conversion(unit, wanted)
    assert found.factor == pytest.approx(factor, rel=1e-14)
    assert found.offset == 0.0


def test_a_scale_with_another_zero_has_an_offset() -> None:
    found = conversion("°C", "K")
    assert (found.factor, found.offset) == (pytest.approx(1.0), pytest.approx(273.15))


@pytest.mark.parametrize(
    ("unit", "wanted", "said"),
    [
        ("V", "N m", "not in N m"),
        ("m/s", "rad/s", "not in rad/s"),
        ("%", "rad/s", "not in rad/s"),
        ("bananas", "N m", "no unit that is known"),
        ("1/s", "rad/s", "radians or of revolutions"),
        ("((", "N m", "is in"),
    ],
)
def test_what_is_no_such_unit_is_refused(unit: str, wanted: str, said: str) -> None:
    with pytest.raises(UnitError, match=said) as caught:
        conversion(unit, wanted)
    assert caught.value.fix


@given(st.text(max_size=30))
def test_any_text_is_converted_or_refused(unit: str) -> None:
    try:
        found = conversion(unit, "N m")
    except UnitError as error:
        assert "is in" in error.what
    else:
        assert math.isfinite(found.factor)


def test_a_dash_says_that_there_is_no_unit() -> None:
    assert not any(map(has_unit, ("", "-", " 1 ", "[-]")))
    assert has_unit("rpm")
    assert all(map(is_spelled, ("Nm", "kN m", "1/min", "km/h", "-", "°/s")))
    assert not any(map(is_spelled, ("motor", "bananas")))
