"""Names, numbers and units as people read them, and symbols as HTML and as Matplotlib's mathtext.

Numbers have significant digits, thin spaces and a true minus sign. A label's text may come from a user's
file, so both forms escape it.
"""

from __future__ import annotations

import html
import math
import re
from collections.abc import Mapping
from typing import NamedTuple

from hil.core.channels import CHANNELS
from hil.core.errors.wording import factor as plain_factor
from hil.core.errors.wording import printable
from hil.core.errors.wording import share as plain_share

_SHORT = {
    "motor_torque_ref_nm": "Torque request",
    "motor_torque_nm": "Motor torque",
    "motor_speed_rad_s": "Motor speed",
    "wheel_speed_rad_s": "Wheel speed",
    "shaft_torque_nm": "Shaft torque",
    "wheel_speed_left_rad_s": "Wheel speed, left",
    "wheel_speed_right_rad_s": "Wheel speed, right",
    "shaft_torque_left_nm": "Shaft torque, left",
    "shaft_torque_right_nm": "Shaft torque, right",
    "vehicle_speed_m_s": "Vehicle speed",
    "driving_torque_ref_nm": "Driving torque, reference",
    "driving_torque_est_nm": "Driving torque, estimate",
    "dyno_torque_ref_nm": "Load torque",
    "motor_angle_rad": "Motor angle",
    "wheel_angle_rad": "Wheel angle",
}
_KNOWN = re.compile(
    r"(?<!\w)("
    + "|".join(
        re.escape(c.symbol)
        for c in sorted(CHANNELS.values(), key=lambda c: -len(c.symbol))
        if "_" in c.symbol
    )
    + r")(?!\w)"
)
_NAMES = re.compile(rf"(['\"]?)\b({'|'.join(_SHORT)})\b\1")
_HAT = "\u0302"
_SYMBOL = re.compile(r"(?P<base>[^_*]+)(?:_(?P<sub>[^*]+))?(?P<star>\*?)$")


class Label(NamedTuple):
    """Words, then a symbol of `hil.core.channels` such as 'ω_m' or 'rF_d*', then more words."""

    text: str
    symbol: str = ""
    tail: str = ""

    def as_html(self) -> str:
        """Escaped HTML; Plotly reads this subset of HTML too."""
        return self._join(html.escape(self.text), _symbol_html(self.symbol), html.escape(self.tail))

    def as_mathtext(self) -> str:
        """Matplotlib text: only the symbol is mathematics, a dollar in the words stays a dollar."""
        words, tail = (part.replace("$", r"\$") for part in (self.text, self.tail))
        return self._join(words, _symbol_mathtext(self.symbol), tail)

    def plain(self) -> str:
        """For alternative texts and documents without mathematics."""
        return self._join(self.text, self.symbol, self.tail)

    def _join(self, words: str, symbol: str, tail: str) -> str:
        return " ".join(part for part in (words, symbol) if part) + tail


def channel_label(name: str) -> Label:
    """Short words and symbol of a channel; an unknown channel keeps its name."""
    symbol = CHANNELS[name].symbol if name in CHANNELS else ""
    return Label(_SHORT.get(name, printable(name, 80)), symbol)


def criterion_title(id_: str) -> str:
    """An id of a criterion in words: 'a.peak_shaft_torque.below.b' is 'Peak shaft torque, a below b'."""
    segment, _, rest = id_.partition(".")
    metric, _, rival = rest.partition(".below.")
    if not metric:
        return id_
    words = metric.replace("_", " ").replace(".", ", ")
    return f"{capitalised(words)}, {segment}" + (f" below {rival}" if rival else "")


#: Units at the end of names, a torque's with what it is over.
_UNIT = re.compile(r"_((nms?2?|kg)(_(rad|s|m)[23]?)?|rad_s|rad|m_s|s|hz|deg_c|deg|m|w)$")


def parameter_title(name: str) -> str:
    """A parameter of a model or an effect in words, its unit left to a column of its own."""
    id_, _, number = name.rpartition(".")
    words = _UNIT.sub("", number).replace("_", " ")
    return f"{id_.replace('.', ', ').replace('_', ' ')}, {words}".removeprefix(", ")


def capitalised(text: str) -> str:
    """With a capital first, all else as it is."""
    return text[:1].upper() + text[1:]


def as_sentence(text: str) -> str:
    """With a capital and a full stop."""
    return capitalised(text) + ("" if text.endswith((".", "!", "?")) else ".")


def with_titles(text: str) -> str:
    """A sentence with the names of channels in words: 'shaft_torque_nm' becomes shaft torque."""
    return _NAMES.sub(lambda found: _SHORT[found[2]].lower(), text)


def pieces(text: str) -> list[tuple[str, bool]]:
    """A sentence cut at the symbols of channels in it: (piece, whether it is a symbol)."""
    return [(piece, number % 2 == 1) for number, piece in enumerate(_KNOWN.split(text)) if piece]


def sentence_html(text: str) -> str:
    """A sentence as escaped HTML with its symbols set as such."""
    return "".join(_symbol_html(piece) if known else html.escape(piece) for piece, known in pieces(text))


def channel_unit(name: str, stated: Mapping[str, str] | None = None) -> str:
    """Unit of a known channel, else the one that a recording states (its table `units`), else ''."""
    return CHANNELS[name].unit if name in CHANNELS else printable((stated or {}).get(name, ""), 20)


def _symbol_html(symbol: str) -> str:
    found = _SYMBOL.match(symbol)
    if found is None:
        return html.escape(symbol)
    sub = f"<sub>{html.escape(found['sub'])}</sub>" if found["sub"] else ""
    return f"<i>{html.escape(found['base'])}</i>{sub}{found['star']}"


def _symbol_mathtext(symbol: str) -> str:
    found = _SYMBOL.match(symbol)
    if found is None:
        return symbol.replace("$", r"\$")
    base = re.sub(f"(.){_HAT}", r"\\hat{\1}", found["base"]).replace("ω", r"\omega ")
    sub = rf"_\mathrm{{{found['sub']}}}" if found["sub"] else ""
    star = "^{*}" if found["star"] else ""
    return f"${base}{sub}{star}$"


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
    """A share in percent (`hil.core.errors.wording`), set as numbers are here; a dash for None and NaN."""
    if value is None or math.isnan(value):
        return DASH
    text = plain_share(value, decimals, digits=digits, signed=signed)
    text = re.sub(r"e([+-]\d+)", lambda found: f" × 10{_superscript(int(found[1]))}", text)
    text = re.sub(r"(?<![\d.])\d{5,}", lambda found: f"{int(found[0]):,}".replace(",", THIN), text)
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
