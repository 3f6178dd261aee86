"""A tuned controller on a bench: refined by runs, and the first of them beside its prediction.

A first run that deviates from the prediction is diagnosed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from hil.analysis.diagnosis import Diagnosis
from hil.analysis.tuning import Confirmation, Refinement, RefinementBudget, Tuning, refine
from hil.app.diagnose import diagnose_recordings
from hil.app.feedback import Feedback
from hil.app.requests import DiagnoseRequest
from hil.app.result_file import Outcome
from hil.app.tuning.bench_runs import FOLDER, Allowed, WireBench
from hil.core.errors import HilError
from hil.engine import RECORDING
from reports.outputs.tuning import refinement_summary
from reports.tuning_report import Shown

DIAGNOSIS = "diagnosis"


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


@dataclass(frozen=True)
class FirstRun:
    """The first run beside its prediction.

    `diagnosed` is the folder of its diagnosis or why there is none; '' where it came as predicted.
    """

    confirmation: Confirmation
    diagnosed: str

    def as_json(self) -> dict[str, Any]:
        """`confirmed` of tune.json."""
        return {
            "agrees": self.confirmation.agrees,
            "passed": self.confirmation.passed,
            "allowed": self.confirmation.allowed,
            "criteria": [
                {
                    "id": one.id,
                    "predicted": one.predicted.value,
                    "measured": one.measured.value,
                    "unit": one.unit,
                    "apart": one.apart,
                    "verdict": one.measured.verdict,
                }
                for one in self.confirmation.criteria
            ],
            "run": f"{FOLDER}/01",
            "diagnosis": self.diagnosed,
        }


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


def compare_first_run(refined: Refined, allowed: float, diagnose: Callable[[], str]) -> FirstRun | None:
    """The first run beside its prediction, diagnosed if it deviates; None if nothing was measured.

    Args:
        allowed: largest difference, a share of a criterion's limit.
    """
    if not refined.found.runs or not refined.found.runs[0].measured:
        return None
    confirmed = refined.found.runs[0].beside_prediction(allowed)
    return FirstRun(confirmed, "" if confirmed.agrees or refined.exit_code else diagnose())


def diagnose_first_run(
    wire: WireBench,
    request: DiagnoseRequest,
    feedback: Feedback,
    report: Callable[[Outcome[Diagnosis]], None],
) -> str:
    """Diagnose the first run as `request` says; the folder with the results, or why there are none."""
    recording: Path = wire.outcomes[1].folder / RECORDING
    try:
        report(diagnose_recordings(replace(request, recordings=[recording]), feedback))
    except HilError as error:
        return f"no diagnosis: {error.what}"
    return str(request.out)
