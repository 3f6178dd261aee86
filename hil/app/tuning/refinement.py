"""Refines a tuned controller where it is measured."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from hil.analysis.tuning import Refinement, RefinementBudget, Tuning, refine
from hil.app.feedback import Feedback
from hil.app.tuning.bench_runs import FOLDER, Allowed, WireBench
from reports.outputs.tuning import refinement_summary
from reports.tuning_report import Shown


@dataclass(frozen=True)
class Refined:
    """What the runs came to; `exit_code` is the largest of runs that failed or were interrupted, or 0."""

    found: Refinement
    allowed: Allowed
    shown: Shown | None
    exit_code: int

    def as_json(self) -> dict[str, Any]:
        """`refined` of tune.json."""
        return refinement_summary(self.found, {**self.allowed.as_json(), "folder": FOLDER})


def refine_on(
    wire: WireBench,
    found: Tuning,
    budget: RefinementBudget,
    processes: int | None,
    feedback: Feedback,
    stopped: Callable[[], bool],
) -> Refined:
    """Refine on a bench the controller that was found on the model."""
    refinement = refine(
        found.trial,
        found.space,
        found.space.point(found.chosen.values),
        wire,
        budget=budget,
        processes=processes,
        show=lambda text, share: feedback.note(text),
        stopped=lambda: stopped() or wire.exit_code > 0,
    )
    best = refinement.best
    shown = None if best is None else wire.outcomes[best.number].shown("measured")
    return Refined(refinement, wire.allowed, shown, wire.exit_code)
