"""A tuned controller on the wire at once, and a diagnosis where the run is not as predicted."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from hil.analysis.diagnosis import Diagnosis
from hil.analysis.tuning import Confirmation, Tuning, confirmation
from hil.app.diagnose import diagnose_recordings
from hil.app.requests import DiagnoseRequest
from hil.app.result_file import Outcome
from hil.app.run import RunSettings
from hil.app.tuning.bench_runs import name_in
from hil.core.errors import BadInputError, HilError
from hil.core.recording import Recording, read_recording
from hil.core.result import Segment
from hil.engine import RECORDING, BenchFile
from reports.tuning_report import Shown
from test_plans import Choices, Plan, load_plan

RUN, DIAGNOSIS = "run", "diagnosis"


@dataclass(frozen=True)
class OnTheWire:
    """How the tuned controller is tried.

    Attributes:
        allowed: largest difference from the prediction, a share of a criterion's limit.
        settings: who answers for the run, and whether results are replaced.
    """

    bench: BenchFile
    allowed: float
    settings: RunSettings


@dataclass(frozen=True)
class Ran:
    """What came of it; `exit_code` is the run's."""

    confirmation: Confirmation
    recording: Recording
    segments: tuple[Segment, ...]
    exit_code: int
    diagnosed: str = ""

    @property
    def shown(self) -> Shown:
        """The run as one of the compared responses."""
        return Shown("measured", self.recording, self.segments)


def refuse_unasked(plan: Plan) -> None:
    """Refuse to run a plan for which somebody must answer.

    Raises:
        BadInputError: it is hazardous.
    """
    if plan.hazardous:
        raise BadInputError(
            "a hazardous plan needs authorisation by name",
            where=f"plan '{plan.name}'",
            fix="omit --then-run; then run: hil run --controller … --confirm 'YOUR NAME'",
        )


def run_tuned(
    found: Tuning,
    plan: str,
    place: Path,
    wire: OnTheWire,
    model: Path,
    report_diagnosis: Callable[[Outcome[Diagnosis]], None],
) -> Ran:
    """Run the plan with the controller that lies in `place`, beside the prediction on the model itself.

    Raises:
        HilError: the run failed before anything was measured.
    """
    file = found.trial.driven.file
    chosen = load_plan(plan, Choices({name_in(plan, file): place / "controller.toml"}))
    with wire.settings.execute(chosen, wire.bench, place / RUN) as run:
        result, exit_code = run.result, run.exit_code
    recording = read_recording(place / RUN / RECORDING, least_samples=0, allow_missing=True)
    confirmed = confirmation(found.chosen.nominal.criteria, result.criteria, wire.allowed)
    ran = Ran(confirmed, recording, tuple(result.segments), exit_code)
    if confirmed.agrees or exit_code > 1:
        return ran
    return replace(ran, diagnosed=_diagnose(place, model, wire.settings, report_diagnosis))


def _diagnose(
    place: Path, model: Path, settings: RunSettings, report: Callable[[Outcome[Diagnosis]], None]
) -> str:
    """Diagnose the run with the model; where its results are, or why there are none."""
    request = DiagnoseRequest(
        model=model,
        recordings=[place / RUN / RECORDING],
        out=place / DIAGNOSIS,
        overwrite=settings.overwrite,
    )
    try:
        report(diagnose_recordings(request, settings.feedback))
    except HilError as error:
        return f"no diagnosis: {error.what}"
    return str(place / DIAGNOSIS)


def as_json(ran: Ran) -> dict[str, Any]:
    """As it stands in tune.json."""
    return {
        "agrees": ran.confirmation.agrees,
        "passed": ran.confirmation.passed,
        "allowed": ran.confirmation.allowed,
        "criteria": [
            {
                "id": one.id,
                "predicted": one.predicted.value,
                "measured": one.measured.value,
                "unit": one.unit,
                "apart": one.apart,
                "verdict": one.measured.verdict,
            }
            for one in ran.confirmation.criteria
        ],
        "run": RUN,
        "diagnosis": ran.diagnosed,
    }
