"""Text that came from a file, as a terminal or a report may show it."""

from __future__ import annotations

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
