"""Everything that can be known of a plan before a bench is touched."""

from __future__ import annotations

import datetime
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from hil.app.feedback import LOGGED, Feedback
from hil.app.requests import CheckRequest
from hil.core.controller import load_controller
from hil.core.errors import BadInputError
from hil.core.errors.extras import not_installed
from hil.core.errors.mistakes import all_of
from hil.core.model import load_model
from hil.engine import DEFAULT_BENCH, BenchFile, load_bench
from hil.engine.bench.bench_channels import accepted_expiry
from hil.engine.bench.measured import refuse_unmeasured
from hil.engine.prediction.batch_prediction import controller_files
from hil.engine.prediction.forecast import Forecast, forecast
from hil.engine.run.preflight import preflight
from test_plans import Plan, largest_requests_nm, load_plan
from test_plans.steps import Step

if TYPE_CHECKING:
    from hil.analysis.control_design import Margins

#: A loop this close to -1 shakes with the next degree of temperature: 1 over it is the distance to -1.
_WARN_SENSITIVITY = 3.0


@dataclass(frozen=True)
class Checked:
    """What is known of a plan: its forecast, and the margins of the loop that each controller closes.

    `remarks`: what of the bench's files was converted or had to be assumed.
    """

    plan: Plan
    bench: str
    forecast: Forecast
    loops: Mapping[str, Margins]
    remarks: tuple[str, ...] = ()

    @property
    def warnings(self) -> list[str]:
        """What to say of loops, of held wheels, of the bench's files, and of what no check covers."""
        unjudged = (f"not checked: {text}" for text in self.plan.device_gaps)
        return [*_of_loops(self.loops), *_of_held_wheels(self.plan), *self.remarks, *unjudged]

    def as_json(self) -> dict[str, object]:
        """The JSON object of `hil check --json`."""
        plan, predicted = self.plan, self.forecast
        peaks = {name: {"value": value, "limit": limit} for name, (value, limit) in predicted.peaks.items()}
        return {
            "plan": plan.name,
            "bench": self.bench,
            "fits": predicted.fits,
            "duration_s": round(predicted.duration_s, 1),
            "steps": len(plan.steps),
            "segments": [segment.id for segment in plan.segments],
            "predicted": peaks,
            "largest_requests_nm": largest_requests_nm(plan),
            "bus_loads": {name: round(load, 4) for name, load in predicted.bus_loads.items()},
            "not_checked": list(plan.device_gaps),
            "criteria": [
                {**criterion.model_dump(exclude={"definition"}), "margin": criterion.margin}
                for criterion in predicted.criteria
            ],
            "remarks": list(self.remarks),
            "loops": _margins_json(self.loops),
        }


def check_plan(request: CheckRequest, feedback: Feedback = LOGGED) -> Checked:
    """Check a plan against a bench, and predict its run.

    Raises:
        BadInputError: plan or bench has mistakes, all of which are named, or they do not fit each other.
    """
    plan, bench = _loaded(request)
    with tempfile.TemporaryDirectory() as directory:
        today = datetime.datetime.now(datetime.UTC).date()
        accepted_expiry(bench, today, "")
        preflight(plan, bench, Path(directory))
    refuse_unmeasured(bench)
    with feedback.progress(plan.name) as show:
        show("predicting")
        predicted = forecast(plan, bench)
    try:
        loops = loop_margins(plan, bench)
    except ModuleNotFoundError as error:
        missing = not_installed(error)
        if missing is None:
            raise
        feedback.warn(f"no margins of the loops: {missing}")
        loops = {}
    remarks = tuple(text for table in bench.device_tables.values() for text in table.remarks())
    return Checked(plan, bench.name, predicted, loops, remarks)


def _loaded(request: CheckRequest) -> tuple[Plan, BenchFile]:
    """Plan and bench file; what is wrong with either is reported at once."""
    refused = []
    try:
        plan = load_plan(request.plan, request.choices)
    except BadInputError as error:
        refused.append(error)
    try:
        bench = load_bench(request.bench)
    except BadInputError as error:
        refused.append(error)
    all_of(refused)
    return plan, bench


def loop_margins(plan: Plan, bench: BenchFile) -> dict[str, Margins]:
    """Of each controller file of a plan, by its name, on the bench's model or the shipped bench's."""
    from hil.analysis.tuning import SpeedLoops  # slow to load

    simulation = bench.simulation or load_bench(DEFAULT_BENCH).simulation
    assert simulation is not None, "the default bench is simulated"
    model = load_model(simulation.model)
    found = {}
    for file in controller_files(plan, bench):
        if Path(file).is_absolute():  # others are designed during the run
            controller = load_controller(file)
            found[file.stem] = SpeedLoops([model], controller.sample_time_s).margins(controller, 0)
    return found


def _of_loops(found: Mapping[str, Margins]) -> Iterable[str]:
    """What to say of loops that are not stable, or hardly."""
    for name, one in found.items():
        if not one.stable:
            yield f"controller '{name}': its speed loop is not stable on the bench's model"
        elif one.sensitivity_peak > _WARN_SENSITIVITY:
            yield (
                f"controller '{name}': its speed loop is close to instability, |S| = "
                f"{one.sensitivity_peak:.3g} at {one.sensitivity_peak_hz:.3g} Hz"
            )


def _of_held_wheels(plan: Plan) -> Iterable[str]:
    """What to say of driving torque on wheels that the dynos hold: the table's loops are those of the car."""
    names = list(dict.fromkeys(_held(plan.steps)))
    if names:
        shown = ", ".join(f"'{name}'" for name in names[:5]) + (", …" if len(names) > 5 else "")
        yield (
            f"driving torque while the dynos hold the speed (load: speed, segment {shown}): the loop "
            "margins in the table apply to the vehicle only; driving force control then acts on wheels of "
            "fixed speed, see the predicted peaks"
        )


def _held(steps: Iterable[Step]) -> Iterator[str]:
    for step in steps:
        if getattr(step, "load", "") == "speed" and getattr(step, "quantity", "") == "driving_torque":
            yield from (segment.id for segment in step.segments())
        yield from _held(getattr(step, "steps", ()))


def _margins_json(found: Mapping[str, Margins]) -> dict[str, dict[str, float | bool]]:
    """As numbers; infinite ones become null."""
    return {
        name: {
            "stable": one.stable,
            "gain_margin_db": one.gain_margin_db,
            "phase_margin_deg": one.phase_margin_deg,
            "delay_margin_s": one.delay_margin_s,
            "sensitivity_peak": one.sensitivity_peak,
            "sensitivity_peak_hz": one.sensitivity_peak_hz,
        }
        for name, one in found.items()
    }
