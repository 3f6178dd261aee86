"""Which controller file drives which segment of a plan."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from hil.core.errors import BadInputError
from hil.core.errors.wording import did_you_mean
from hil.core.vehicle import VehicleAndRoad
from test_plans import PROMPT_TIMEOUT_S, Array, Criterion, Plan, PlannedSegment, Quantity, Work


@dataclass(frozen=True)
class Driven:
    """The controller of a plan that is tuned: its file, segments that it drives, criteria that hang on it."""

    file: Path
    segments: tuple[str, ...]
    criteria: tuple[Criterion, ...]


def driven_by(plan: Plan, name: str = "") -> Driven:
    """What of a plan hangs on one of its controllers, named by its file's stem; '' for the last that drives.

    Raises:
        BadInputError: the plan loads no such controller, or nothing that is judged depends on it.
    """
    walk = ControllerWalk()
    for step in plan.steps:
        step.execute(walk)
    files = list(dict.fromkeys(file for file in walk.driver.values() if file.is_absolute()))
    if not files:
        raise BadInputError(
            "no criterion depends on a controller, because no controller drives a segment",
            where=f"plan '{plan.name}'",
            fix="name a plan with set_controller and steps of driving_torque, such as acceptance",
        )
    stems = {file.stem: file for file in files}
    if name and name not in stems:
        raise BadInputError(
            f"no segment is driven by a controller '{name}'",
            where=f"plan '{plan.name}'",
            fix=f"{did_you_mean(name, stems)}; --start FILE begins at one that the plan does not name",
        )
    file = stems[name] if name else files[-1]
    segments = tuple(segment for segment, driver in walk.driver.items() if driver == file)
    criteria = tuple(
        c
        for c in plan.criteria
        if (c.segment in segments or c.below in segments)
        and not (c.upper is None and c.lower is None and c.below is None)
    )
    if not criteria:
        raise BadInputError(
            f"no criterion with a limit depends on the controller '{file.stem}'",
            where=f"plan '{plan.name}'",
            fix=f"give a limit to a criterion of {', '.join(segments)}, or name another with --controller",
        )
    _refuse_contradictions(criteria, plan)
    return Driven(file, segments, criteria)


def _refuse_contradictions(criteria: tuple[Criterion, ...], plan: Plan) -> None:
    """Refuse two criteria on one value that nothing can hold."""
    for one in criteria:
        for other in criteria:
            same = one.segment == other.segment and one.metric == other.metric
            if same and one.lower is not None and other.upper is not None and one.lower > other.upper:
                raise BadInputError(
                    f"the limits contradict each other: {one.id} is to be at least {one.lower:g} and "
                    f"{other.id} at most {other.upper:g} {one.metric.unit}, of one and the same value",
                    where=f"plan '{plan.name}'",
                    fix="change one of them",
                )


class ControllerWalk:
    """A `Conductor` that only remembers which controller file is loaded when a segment is driven."""

    sample_time_s = 0.001

    def __init__(self) -> None:
        self.file = Path()
        self.driver: dict[str, Path] = {}

    def set_controller(self, file: Path) -> None:
        """From now on."""
        self.file = file

    def play(self, quantity: Quantity, samples_nm: Array, segment: PlannedSegment | None) -> None:
        """A segment of driving torque depends on the controller; one of motor torque does not."""
        del samples_nm
        if segment is not None and quantity == "driving_torque":
            self.driver[segment.id] = self.file

    def hold_speed(self, speed_m_s: float, duration_s: float) -> None:
        """Nothing to remember."""

    def set_slip(self, slip: float) -> None:
        """Nothing to remember."""

    def set_vehicle(self, vehicle: VehicleAndRoad) -> None:
        """Nothing to remember."""

    def release_vehicle(self) -> None:
        """Nothing to remember."""

    def coast(self, duration_s: float) -> None:
        """Nothing to remember."""

    def wait(self, duration_s: float) -> None:
        """Nothing to remember."""

    def prompt(self, text: str, timeout_s: float = PROMPT_TIMEOUT_S, picture: str = "") -> None:
        """Nothing to remember."""

    def ramp_down(self, duration_s: float) -> None:
        """Nothing to remember."""

    def analyse(self, name: str, work: Work, makes: tuple[str, ...]) -> None:
        """Nothing to remember."""
