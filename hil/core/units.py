"""What a unit is in another one: the one place that knows units, asked by every reader of files.

Spellings of the field come first, since a library of units reads some of them otherwise: "Nm" is N m and no
number of a yarn, "1/min" of a shaft is a revolution. All else is pint's to say.
"""

from __future__ import annotations

import functools
import re
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from hil.core.channels import CHANNELS
from hil.core.errors import BadInputError
from hil.core.errors.wording import printable

_LONGEST = 40
_SIGNS = str.maketrans(
    {"·": "*", "⋅": "*", "×": "*", "−": "-", "μ": "µ", "²": "^2", "³": "^3", "⁻": "^-", "¹": "1"}
)
#: What is written, without blanks and in small letters, as pint has it.
_SPELLINGS = {
    **dict.fromkeys(("nm", "n*m", "newtonmeter", "newtonmetre", "n-m", "n.m"), "N*m"),
    **dict.fromkeys(("knm", "kn*m", "kn-m", "kn.m"), "kN*m"),
    **dict.fromkeys(("mnm", "mn*m"), "mN*m"),
    **dict.fromkeys(("nmm", "n*mm"), "N*mm"),
    **dict.fromkeys(
        ("ft-lb", "ft*lb", "ftlb", "lb-ft", "lbft", "lb*ft", "lbf*ft", "ft*lbf", "ft-lbf"), "ft*lbf"
    ),
    **dict.fromkeys(("rpm", "1/min", "min-1", "min^-1", "/min", "u/min", "upm", "rev/min", "r/min"), "rpm"),
    **dict.fromkeys(("rps", "rev/s", "r/s", "u/s", "hz"), "rpm x 60"),
    **dict.fromkeys(("rad/s", "rad/sec", "rads^-1", "rad*s^-1", "rads-1", "radps"), "rad/s"),
    **dict.fromkeys(("deg/s", "°/s", "deg/sec", "grad/s", "degps", "dps"), "deg/s"),
    **dict.fromkeys(("km/h", "kmh", "kph", "kmph", "km*h^-1"), "km/h"),
    **dict.fromkeys(("m/s", "mps", "m/sec", "m*s^-1"), "m/s"),
    **dict.fromkeys(("mph", "mi/h"), "mile/hour"),
    **dict.fromkeys(("s", "sec", "second", "seconds"), "s"),
    **dict.fromkeys(("ms", "msec", "millisecond", "milliseconds"), "ms"),
    **dict.fromkeys(("us", "µs", "usec", "microsecond", "microseconds"), "us"),
    **dict.fromkeys(("ns", "nsec", "nanosecond", "nanoseconds"), "ns"),
    **dict.fromkeys(("°", "deg", "grad", "degree", "degrees"), "deg"),
    **dict.fromkeys(("°c", "degc", "celsius"), "degC"),
    **dict.fromkeys(("k", "kelvin"), "K"),
}
#: In which capital letters count.
_EXACT = {"MNm": "MN*m", "MN m": "MN*m", "MN*m": "MN*m", "mW": "mW", "MW": "MW"}
#: Of a speed no one knows whether radians or revolutions are counted.
_AMBIGUOUS = ("1/s", "s-1", "s^-1", "/s")
_NO_UNIT = ("", "-", "1", "none", "n/a")


class UnitError(ValueError):
    """A unit that is no unit, or none of the quantity that is wanted; `what` and `fix` for a message."""

    def __init__(self, what: str, fix: str) -> None:
        super().__init__(what)
        self.what, self.fix = what, fix


@dataclass(frozen=True)
class Conversion:
    """In the unit that is wanted a value is `factor` times the value that stands there, plus `offset`."""

    factor: float = 1.0
    offset: float = 0.0

    def of(self, values: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Values in the unit that is wanted; those that were given may be overwritten."""
        np.multiply(values, self.factor, out=values)
        if self.offset:
            np.add(values, self.offset, out=values)
        return values

    def of_line(self, scale: float, offset: float) -> tuple[float, float]:
        """Scale and offset of raw values that give values in the unit that is wanted."""
        return scale * self.factor, offset * self.factor + self.offset

    @property
    def is_none(self) -> bool:
        """Whether the value is the same."""
        return self.factor == 1.0 and self.offset == 0.0


def has_unit(unit: str) -> bool:
    """Whether something stands there that says a unit; '-' and '1' say that there is none."""
    return _plain(unit) not in _NO_UNIT


def is_spelled(unit: str) -> bool:
    """Whether this is how a unit of the field is written; not all that is a unit is."""
    return unit.strip() in _EXACT or _plain(unit) in _SPELLINGS or _plain(unit) in (*_AMBIGUOUS, *_NO_UNIT)


def conversion(unit: str, wanted: str) -> Conversion:
    """How values in `unit` become values in `wanted`.

    Raises:
        UnitError: `unit` is not known, says too little, or is of another quantity.
    """
    if _expression(unit) == _expression(wanted):
        return Conversion()
    if _plain(unit) in _AMBIGUOUS and "rad" in wanted:
        raise UnitError(
            f"is in '{_shown(unit)}', of radians or of revolutions",
            "write rad/s or rpm; the bench takes rad/s",
        )
    return _by_pint(unit, wanted)


def converted(
    values: npt.NDArray[np.float64], name: str, unit: str, where: str, notes: list[str]
) -> npt.NDArray[np.float64]:
    """A column of a file in the unit of the channel of its name; a note is added if it was in another one.

    What is no channel stays as it is.

    Raises:
        BadInputError: it cannot be converted.
    """
    if name not in CHANNELS or not has_unit(unit):
        return values
    wanted = CHANNELS[name].unit
    try:
        found = conversion(unit, wanted)
    except UnitError as error:
        raise BadInputError(error.what, where=where, fix=error.fix) from None
    if found.is_none:
        return values
    notes.append(f"'{name}' was converted from {_shown(unit)} to {wanted}")
    return found.of(values)


@functools.lru_cache(256)
def _by_pint(unit: str, wanted: str) -> Conversion:
    import pint

    registry: Any = _registry()
    ours = registry.Unit(_expression(wanted))
    expression, _, times = _expression(unit).partition(" x ")
    try:
        theirs = registry.Unit(expression)
    except Exception:  # the parser raises whatever it stumbles over
        what = f"is in '{_shown(unit)}', which is no unit that is known"
        raise UnitError(what, f"write it in {wanted}") from None
    try:
        zero, one = (float(registry.Quantity(value, theirs).to(ours).magnitude) for value in (0.0, 1.0))
        return Conversion((one - zero) * float(times or 1), zero)
    except (pint.DimensionalityError, pint.OffsetUnitCalculusError):
        raise UnitError(f"is in '{_shown(unit)}', not in {wanted}", f"give it in {wanted}") from None


@functools.cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry(cache_folder=None)


def _expression(unit: str) -> str:
    exact = _EXACT.get(unit.translate(_SIGNS).strip().strip("[]()"))
    found = exact or _SPELLINGS.get(_plain(unit))
    return found if found is not None else re.sub(r"\s+", "*", unit.translate(_SIGNS).strip().strip("[]()"))


def _plain(unit: str) -> str:
    """Without brackets and blanks, in small letters; "N m" and "N·m" are one."""
    text = unit.translate(_SIGNS).strip().strip("[]()").strip().lower()
    return re.sub(r"\s+", "", text) if text.replace(" ", "") in _SPELLINGS else re.sub(r"\s+", "*", text)


def _shown(unit: str) -> str:
    return printable(unit.strip(), _LONGEST)
