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
    "noise": _TESTS.format("data/test_noise.py"),
    "proven": _TESTS.format("data/test_proven.py"),
    "grid": _TESTS.format("data/test_grid.py"),
    "gap": _TESTS.format("data/test_gap.py"),
    "sanity": _TESTS.format("data/test_sanity.py"),
    "trace": _TESTS.format("data/test_trace.py"),
    "problem": _TESTS.format("fit/test_problem.py"),
    "covariance": _TESTS.format("fit/test_covariance.py"),
    "far": _TESTS.format("fit/test_far.py"),
    "slide": _TESTS.format("fit/test_slide.py"),
    "hopping": _TESTS.format("search/test_hopping.py"),
    "least_squares": _TESTS.format("fit/test_least_squares.py"),
    "whitening": _TESTS.format("fit/test_whitening.py"),
    "whole_samples": _TESTS.format("fit/test_whole_samples.py"),
    "alignment": _TESTS.format("search/test_alignment.py"),
    "by_chance": _TESTS.format("search/test_by_chance.py"),
    "evidence": _TESTS.format("search/test_evidence.py"),
    "predicted": _TESTS.format("search/test_predictable.py"),
    "laws": _TESTS.format("search/test_laws_of_others.py"),
    "orders": _TESTS.format("search/test_orders.py"),
    "quantization": _TESTS.format("search/test_quantization.py"),
    "race": _TESTS.format("search/test_race.py"),
    "rank": _TESTS.format("search/test_rank.py"),
    "transfer_functions": _TESTS.format("test_transfer_functions.py"),
    "screen": _TESTS.format("search/test_screen.py"),
    "tracking": _TESTS.format("search/test_tracking.py"),
    "wandering": _TESTS.format("search/test_wandering.py"),
    "width": _TESTS.format("search/test_width.py"),
    "confidence": _TESTS.format("tell/test_confidence.py"),
    "consequences": _TESTS.format("tell/test_consequences.py"),
    "drift": _TESTS.format("tell/test_drift.py"),
    "least": _TESTS.format("tell/test_least.py"),
    "named": _TESTS.format("tell/test_named.py"),
    "separating": _TESTS.format("tell/test_separating.py"),
    "verdict": _TESTS.format("tell/test_verdict.py"),
    "lines": _TESTS.format("tell/test_lines.py"),
    "words": _TESTS.format("tell/test_words.py"),
}
