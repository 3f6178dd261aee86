"""What a threshold of the diagnosis means, beside its value."""

from __future__ import annotations

from typing import NamedTuple


class Means(NamedTuple):
    """Unit of a threshold, what it decides, and the check (a key of `CHECKS`) that shows if it is right."""

    unit: str
    decides: str
    checked_by: str


_TESTS = ".venv/bin/python -m pytest tests/hil/analysis/diagnosis/{}"
#: The command behind each name of a check.
CHECKS = {
    "bad_input": _TESTS.format("test_bad_input.py"),
    "gap": _TESTS.format("data/test_gap.py"),
    "consequences": _TESTS.format("findings/test_consequences.py"),
    "least": _TESTS.format("findings/test_least.py"),
    "separating": _TESTS.format("findings/test_separating.py"),
    "held_out": _TESTS.format("findings/test_held_out.py"),
    "words": _TESTS.format("findings/test_words.py"),
}
