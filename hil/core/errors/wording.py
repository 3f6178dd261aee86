"""Text of messages: what may be shown, what was meant, and numbers with digits that mean something.

Text of messages: what may be shown, what was meant, and numbers with digits that mean something.

Shares and multiples as people read them: digits that mean something (docs/reference/numbers.md).

Plain text, for terminals and sentences; `reports.labels` sets the same with its own spaces and signs.
"""

from __future__ import annotations

import difflib
import math
from collections import Counter
from collections.abc import Iterable, Sequence

from hil.core.errors import BadInputError

#: A share above it has no decimals, and three digits: more mean nothing.
MOST_SHARE = 10.0
#: A multiple above it says that there was nothing to compare with, and no more.
MOST_TIMES = 1000.0
#: A multiple below it is next to nothing.
LEAST_TIMES = 1e-3


def share(value: float, decimals: int = 1, *, digits: int = 1, signed: bool = False) -> str:
    """A share in percent, "12.3 %"; from ten on with three digits, "6330 %", at most "> 100000 %".

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
        return f"{plus if abs(value) <= MOST_TIMES else ''}{_large_percent(value)} %"
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


def _large_percent(value: float) -> str:
    """Three digits of a share above ten, in percent; what is beyond a thousand says no more than that."""
    if abs(value) > MOST_TIMES:
        return f"{'>' if value > 0 else '<'} {math.copysign(100.0 * MOST_TIMES, value):.0f}"
    return f"{float(f'{100.0 * value:.3g}'):.0f}"


LONGEST = 80
#: Characters of a person's name, and of a reason that somebody gives: reports have a line or two for them.
LONGEST_NAME, LONGEST_REASON = 100, 500


def printable(text: object, longest: int = LONGEST) -> str:
    """`text` on one line, what cannot be printed escaped, and cut to `longest` characters.

    A file can hold escape sequences that would move a terminal's cursor or colour its text.
    """
    shown = "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in str(text))
    return shortened(shown, longest)


def shortened(text: str, longest: int) -> str:
    """`text` where only `longest` characters have room: what is cut off leaves "…" in its place."""
    return text if len(text) <= longest else f"{text[: longest - 1]}…"


def refuse_long(text: str, where: str, most: int = LONGEST_NAME) -> None:
    """Refuse what no report has room for, before anything moves.

    Raises:
        BadInputError: `text`, which `where` names, has more than `most` characters.
    """
    if len(text) > most:
        raise BadInputError(
            f"has {len(text)} characters, at most {most} are taken", where=where, fix="shorten it"
        )


def is_printable(text: str) -> bool:
    """Whether nothing of `text` would be escaped."""
    return text.isprintable()


def closest(word: str, known: Iterable[str]) -> str:
    """The one of `known` that may have been meant, or ''."""
    return next(iter(difflib.get_close_matches(word, list(known), n=1)), "")


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """The closest of `known`, and the whole list."""
    choices = list(known)
    close = closest(word, choices)
    hint = f"did you mean '{close}'? " if close else ""
    return f"{hint}known: {', '.join(choices) or 'none'}"


#: Some two screens; the first line is reported whatever its length.
MOST_CHARACTERS = 4000


def listed(findings: Sequence[str]) -> str:
    """Each on an indented line, its further lines below it; the last line counts what is left out."""
    lines: list[str] = []
    characters = 0
    for finding in findings:
        line = "\n  " + finding.replace("\n", "\n  ")
        characters += len(line)
        if lines and characters > MOST_CHARACTERS:
            lines.append(f"\n  and {len(findings) - len(lines)} more, when these are corrected")
            break
        lines.append(line)
    return "".join(lines)


def repeated(names: Iterable[str]) -> list[str]:
    """Names that stand more than once, sorted."""
    return sorted(name for name, count in Counter(names).items() if count > 1)
