"""What `hil tune --on-bench` says of its runs: JSON, and the text for people."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from hil.analysis.tuning import RefinedRun, Refinement
from hil.core.errors.wording import share


def refinement_summary(found: Refinement, asked: Mapping[str, Any]) -> dict[str, Any]:
    """`refined` of tune.json; `asked` says on which bench, within what envelope, with whose consent."""
    return {
        **asked,
        "ended": found.ended,
        "best_run": None if found.best is None else found.best.number,
        "worst_margin": None if found.best is None else found.best.worst,
        "runs": [_run(run) for run in found.runs],
    }


def _run(run: RefinedRun) -> dict[str, Any]:
    return {
        "number": run.number,
        "values": dict(run.values),
        "trust_radius": run.radius,
        "predicted": dict(run.predicted.margins),
        "expected": dict(run.expected),
        "measured": dict(run.measured),
        "decision": run.decision,
        "reason": run.reason,
    }


def refinement_rows(found: Refinement) -> list[tuple[str, ...]]:
    """For each run: number, radius, worst margin predicted, expected, measured; decision and reason."""
    rows = []
    for run in found.runs:
        worst = (_worst(margins) for margins in (run.predicted.margins, run.expected, run.measured))
        rows.append((str(run.number), f"{run.radius:.3f}", *worst, run.decision, run.reason))
    return rows


REFINEMENT_HEAD = ("run", "radius", "predicted", "expected", "measured", "decision", "reason")


def refinement_verdict(found: Refinement) -> str:
    """What came of it, in a sentence or two."""
    if found.best is None:
        return f"Nothing was measured: {found.ended}."
    gained = found.best.worst - found.runs[0].worst
    return (
        f"Run {found.best.number} of {len(found.runs)} is the best: worst margin measured "
        f"{share(found.best.worst)}, {share(gained)} of a limit more than the first run's. "
        f"Ended: {found.ended}."
    )


def _worst(margins: Mapping[str, float]) -> str:
    return share(min(margins.values()), 2) if margins else "–"
