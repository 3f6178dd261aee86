"""Shares and multiples as people read them: digits that mean something (docs/reference/numbers.md).

Plain text, for terminals and sentences; `reports.quantities` sets the same with its own spaces and signs.
"""

from __future__ import annotations

import math

#: A share above it is a multiple: 1000 % has too many digits for what it means.
MOST_SHARE = 10.0
#: A multiple above it says that there was nothing to compare with, and no more.
MOST_TIMES = 1000.0
#: A multiple below it is next to nothing.
LEAST_TIMES = 1e-3


def share(value: float, decimals: int = 1, *, digits: int = 1, signed: bool = False) -> str:
    """A share in percent, "12.3 %"; from ten on as a multiple, "63 times", at most "> 1000 times".

    What is not zero is never written as zero: "0.004 %", "-5e-05 %".

    Args:
        value: a ratio, 1 for 100 %; "-" if it is NaN.
        decimals: of the percent, at least.
        digits: that it has at least, where those decimals would leave fewer: of a gap near its noise three.
        signed: a plus stands before what is positive.
    """
    if math.isnan(value):
        return "-"
    plus = "+" if signed and value > 0 else ""
    if abs(value) > MOST_SHARE:
        return f"{plus if abs(value) <= MOST_TIMES else ''}{_times(value)} times"
    percent = 100.0 * value
    if not percent:
        return f"{0.0:.{decimals}f} %"  # no negative zero
    text = f"{percent:.{decimals}f}"
    needed = digits - 1 - math.floor(math.log10(abs(percent)))
    if needed > decimals and (digits > 1 or not text.strip("-0.")):
        text = f"{percent:.{digits}g}"
    return f"{plus}{text} %"


def factor(value: float) -> str:
    """A multiple that is never negative with three digits, "1.05", at most "> 1000", at least "< 0.001"."""
    if math.isnan(value):
        return "-"
    if value and value < LEAST_TIMES:
        return f"< {LEAST_TIMES:g}"
    return f"> {MOST_TIMES:g}" if value >= MOST_TIMES - 0.5 else f"{value:.3g}"


def multiple(value: float) -> str:
    """The same in words: "1.05 times", to be followed by what it is a multiple of."""
    return f"{factor(value)} times"


def quantity(value: float, unit: str, digits: int = 3) -> str:
    """A value in its unit with as many digits, all those before the point: "12.3 N m", "6104 rad/s".

    Powers of ten only from ten million on and below a ten-thousandth.
    """
    size = abs(value)
    if not math.isfinite(value) or size >= 1e7 or 0.0 < size < 1e-4:
        text = f"{value:.{digits - 1}e}" if math.isfinite(value) else "-"
    else:
        decimals = max(digits - 1 - math.floor(math.log10(size)), 0) if size else 0
        text = f"{value:.{decimals}f}"
    return f"{text} {unit}".rstrip()


def _times(value: float) -> str:
    """Two digits of a multiple between ten and a hundred, three of a larger one."""
    if value > MOST_TIMES:
        return f"> {MOST_TIMES:g}"
    return f"< -{MOST_TIMES:g}" if value < -MOST_TIMES else f"{value:.0f}"
