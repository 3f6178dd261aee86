"""Text that came from a file, as a terminal or a report may show it."""

from __future__ import annotations

LONGEST = 80


def printable(text: object, longest: int = LONGEST) -> str:
    """`text` on one line, what cannot be printed escaped, and cut to `longest` characters.

    A file can hold escape sequences that would move a terminal's cursor or colour its text.
    """
    shown = "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in str(text))
    return shown if len(shown) <= longest else f"{shown[: longest - 1]}…"


def is_printable(text: str) -> bool:
    """Whether nothing of `text` would be escaped."""
    return text.isprintable()
