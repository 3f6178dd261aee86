"""Text of messages: what may be shown, what was meant, several findings at once."""

from __future__ import annotations

import difflib
from collections import Counter
from collections.abc import Iterable, Sequence

from hil.core.errors import BadInputError

LONGEST = 80
#: Characters of a person's name, and of a reason that somebody gives: reports have a line or two for them.
LONGEST_NAME, LONGEST_REASON = 100, 500


def printable(text: object, longest: int = LONGEST) -> str:
    """`text` on one line, what cannot be printed escaped, and cut to `longest` characters.

    A file can hold escape sequences that would move a terminal's cursor or colour its text.
    """
    shown = "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in str(text))
    return shown if len(shown) <= longest else f"{shown[: longest - 1]}…"


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
