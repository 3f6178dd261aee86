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
    "blind": "make blind",
    "hidden": ".venv/bin/python -m benchmarks.diagnosis",
    "bad_input": _TESTS.format("test_bad_input.py"),
    "coherence": _TESTS.format("data/test_coherence.py"),
    "whole_samples": _TESTS.format("fit/test_whole_samples.py"),
    "alignment": _TESTS.format("search/test_alignment.py"),
    "by_chance": _TESTS.format("search/test_by_chance.py"),
    "tracking": _TESTS.format("search/test_tracking.py"),
    "separating": _TESTS.format("tell/test_separating.py"),
}
