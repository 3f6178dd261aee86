"""`hil tune --then-run`: the tuned controller on the wire at once, and why where it is not as predicted."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hil.analysis.tuning import Confirmation, Tuning, confirmation
from hil.cli._one_run import Runs
from hil.cli._output import console, plain_table
from hil.cli.commands.diagnose import Diagnose
from hil.core.digits import share
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
        runs: who answers for the run, and whether results are replaced.
    """

    bench: BenchFile
    allowed: float
    runs: Runs


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


def then_run(found: Tuning, plan: str, place: Path, wire: OnTheWire, model: Path) -> Ran:
    """Run the plan with the controller that lies in `place`, beside the prediction on the model itself.

    Raises:
        HilError: the run failed before anything was measured.
    """
    file = found.trial.driven.file
    chosen = load_plan(plan, Choices({_name_in(plan, file): place / "controller.toml"}))
    with wire.runs.finished(chosen, wire.bench, place / RUN) as run:
        result, exit_code = run.result, run.exit_code
    recording = read_recording(place / RUN / RECORDING, least_samples=0, allow_missing=True)
    told = confirmation(found.chosen.nominal.criteria, result.criteria, wire.allowed)
    ran = Ran(told, recording, tuple(result.segments), exit_code)
    if told.agrees or exit_code > 1:
        return ran
    diagnosed = _diagnosed(place, model, overwrite=wire.runs.overwrite)
    return Ran(told, recording, tuple(result.segments), exit_code, diagnosed)


def _name_in(plan: str, file: Path) -> str:
    """What the plan calls a controller file."""
    text = load_plan(plan).text
    return next((name for name in (str(file), file.name) if name in text), file.name)


def _diagnosed(place: Path, model: Path, *, overwrite: bool) -> str:
    """Diagnose the run with the model; where its results are, or why there are none."""
    try:
        recordings = [place / RUN / RECORDING]
        asked = Diagnose(
            model=model, recordings=recordings, out=place / DIAGNOSIS, at_most=10.0, overwrite=overwrite
        )
        asked.carry_out()
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


def tell(ran: Ran) -> None:
    """Predicted and measured side by side."""
    page, table = console(), plain_table("\npredicted and measured")
    table.add_column("criterion", no_wrap=True)
    for name in ("predicted", "measured", "difference"):
        table.add_column(name, justify="right")
    table.add_column("unit")
    table.add_column("of the limit", justify="right")
    table.add_column("run")
    for one in ran.confirmation.criteria:
        difference = "-" if one.difference is None else f"{one.difference:+.3g}"
        apart = share(one.apart, 2) if one.of_limit and one.apart is not None else "-"
        style = "bold red" if one in ran.confirmation.beyond else ""
        values = ("-" if v is None else f"{v:.5g}" for v in (one.predicted.value, one.measured.value))
        table.add_row(one.id, *values, difference, one.unit, apart, one.measured.verdict, style=style)
    page.print(table)
    page.print(_verdict(ran), highlight=False, markup=False, soft_wrap=True)


def _verdict(ran: Ran) -> str:
    allowed = f"{100 * ran.confirmation.allowed:g} % of the limit (of the larger value where there is none)"
    if ran.confirmation.agrees:
        return f"As predicted, within {allowed}."
    names = ", ".join(one.id for one in ran.confirmation.beyond)
    return (
        f"Deviation from the prediction by more than {allowed}: {names}. Diagnosis: {ran.diagnosed or 'none'}"
    )
