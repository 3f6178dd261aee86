"""Numbers and units as people read them: significant digits, thin spaces, a true minus sign."""

from __future__ import annotations

import math
import re

from hil.core.errors.wording import factor as plain_factor
from hil.core.errors.wording import share as plain_share

THIN = "\u202f"  # narrow no-break space
MINUS = "\u2212"
DASH = "\u2013"
_MOST_DECIMALS = 9


def decimals_for(*values: float | None, significant: int = 4) -> int:
    """Decimals that give the largest of `values` `significant` digits; None and NaN do not count."""
    largest = max((abs(v) for v in values if v is not None and math.isfinite(v)), default=0.0)
    if largest == 0.0:
        return 0
    return min(max(significant - 1 - math.floor(math.log10(largest)), 0), _MOST_DECIMALS)


def number(value: float | None, decimals: int | None = None, significant: int = 4) -> str:
    """`value` with `decimals`, or with `significant` digits; powers of ten for the very small and large."""
    if value is None or math.isnan(value):
        return DASH
    if math.isinf(value):
        return "∞" if value > 0 else f"{MINUS}∞"
    size = abs(value)
    if size and (size >= 1e7 or (size < 1e-4 and (decimals is None or decimals >= _MOST_DECIMALS))):
        mantissa, exponent = f"{value:.{significant - 1}e}".split("e")
        return f"{mantissa}{THIN}×{THIN}10{_superscript(int(exponent))}".replace("-", MINUS)
    text = f"{value:,.{decimals_for(value, significant=significant) if decimals is None else decimals}f}"
    if size < 10_000:
        text = text.replace(",", "")
    text = text.replace(",", THIN)
    if text.startswith("-") and not text.strip("-0."):
        text = text[1:]  # no negative zero
    return text.replace("-", MINUS)


def share(value: float | None, decimals: int = 1, *, digits: int = 1, signed: bool = False) -> str:
    """A share in percent, from ten on a multiple (`hil.core.errors.wording`); a dash for None and NaN."""
    if value is None or math.isnan(value):
        return DASH
    text = plain_share(value, decimals, digits=digits, signed=signed)
    text = re.sub(r"e([+-]\d+)", lambda found: f" × 10{_superscript(int(found[1]))}", text)
    return text.replace(" ", THIN).replace("-", MINUS)


def factor(value: float | None) -> str:
    """A multiple that is never negative, at most "> 1000"; a dash for None and NaN."""
    return DASH if value is None or math.isnan(value) else plain_factor(value).replace(" ", THIN)


def chance(share: float) -> str:
    """A probability in percent; nothing is quite certain."""
    return "<1%" if share < 0.005 else ">99%" if share > 0.99 else f"{share:.0%}"


def nominal(value: float | None, of: str = "") -> str:
    """A number that somebody chose (a limit, a speed, a parameter): as written, no digits added."""
    if value is None or not math.isfinite(value):
        return number(value)
    digits = f"{value:.9g}"
    text = number(value) if "e" in digits else number(value, len(digits.partition(".")[2]))
    return f"{text}{THIN}{unit(of)}" if of else text


def unit(text: str) -> str:
    """A unit with narrow no-break spaces between its factors."""
    return text.strip().replace(" ", THIN)


def quantity(value: float | None, of: str, decimals: int | None = None, significant: int = 4) -> str:
    """A number with its unit, kept together on one line; a ratio, of unit 1, is the number alone."""
    text = number(value, decimals, significant)
    return f"{text}{THIN}{unit(of)}" if of not in ("", "1") and text != DASH else text


def file_size(count: int) -> str:
    """Bytes as B, kB or MB (powers of 1000)."""
    if count < 1000:
        return f"{count}{THIN}B"
    return quantity(count / 1e3, "kB", significant=3) if count < 1e6 else quantity(count / 1e6, "MB")


def _superscript(value: int) -> str:
    return str(value).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
