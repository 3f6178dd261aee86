"""What somebody may have meant."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


def closest(word: str, known: Iterable[str]) -> str:
    """The one of `known` that may have been meant, or ''."""
    return next(iter(difflib.get_close_matches(word, list(known), n=1)), "")


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """The closest of `known`, and the whole list."""
    choices = list(known)
    close = closest(word, choices)
    hint = f"did you mean '{close}'? " if close else ""
    return f"{hint}known: {', '.join(choices) or 'none'}"
