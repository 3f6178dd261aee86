"""What is looked at before a bench is touched: dates, controllers, requests against limits, the disk."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from hil.core.channels import TICK_S
from hil.core.controller import Controller, load_controller
from hil.core.errors import BadInputError
from hil.core.files import disk_of
from hil.core.model import Model, load_model
from hil.core.vehicle import VehicleAndRoad
from hil.engine.bench.bench_tables import BenchFile
from test_plans import PROMPT_TIMEOUT_S, Array, Plan, PlannedSegment, Quantity, Work, estimate_duration_s

_BYTES_PER_SECOND = 250_000  # a recording takes some 190 kB for each second of bench time
_REPORT_BYTES = 16_000_000
_COMFORT = 2.0  # others write too, prompts and holds take time


def needed_bytes(plan: Plan) -> int:
    """What a run's files may take."""
    return int(estimate_duration_s(plan) * _BYTES_PER_SECOND) + _REPORT_BYTES


def refuse_too_little_room(plans: Sequence[Plan], out: Path, times: int = 1) -> None:
    """Refuse runs of `plans`, each so many times, for which the disk of folder `out` has no room.

    Raises:
        BadInputError: tells what is free and what may be needed, and names the disk.
    """
    place = out.resolve()
    while not place.exists():
        place = place.parent
    needed, free = times * sum(needed_bytes(plan) for plan in plans), shutil.disk_usage(place).free
    if free < needed:
        what = "the recording" if times * len(plans) == 1 else f"{times * len(plans)} runs"
        raise BadInputError(
            f"{free / 1e6:.0f} MB are free, {what} may need {needed / 1e6:.0f} MB: {disk_of(out)}",
            where=str(out),
            fix="free disk space, or choose another place with --out",
        )


def remark_on_room(plan: Plan, out: Path) -> str:
    """What whoever starts a run that only just fits should know; '' if there is room enough."""
    needed, free = needed_bytes(plan), shutil.disk_usage(out).free
    if free >= _COMFORT * needed:
        return ""
    return f"the run may need {needed / 1e6:.0f} MB of {free / 1e6:.0f} MB that are free: {disk_of(out)}"


def preflight(
    plan: Plan,
    bench: BenchFile,
    out: Path,
    *,
    model: Model | None = None,
    somebody_answers: bool = True,
) -> None:
    """Refuse a run that could not end well.

    Args:
        model: in place of the simulated bench's own.
        somebody_answers: whether prompts reach an operator, or a person has confirmed them beforehand.

    Raises:
        BadInputError: a controller file that cannot be used, a request beyond the
            bench's limits, a prompt that no one can answer on hardware, or too little room on the disk.
    """
    rehearsal = rehearsed(plan, bench, model)
    if rehearsal.prompts and not somebody_answers and bench.simulation is None:
        raise BadInputError(
            f"the operator is asked '{rehearsal.prompts[0]}', and there is no terminal to ask on",
            where=f"plan '{plan.name}'",
            fix="run it from a terminal, or confirm in advance with --yes 'YOUR NAME'; the report prints it",
        )
    refuse_too_little_room([plan], out)


def refuse_unconfirmed(plan: Plan, confirmed_by: str) -> None:
    """Raises:
    BadInputError: the plan is hazardous, and no one has taken it upon them.
    """
    if plan.hazardous and not confirmed_by.strip():
        why = f": {plan.hazardous}" if isinstance(plan.hazardous, str) else ""
        raise BadInputError(
            f"the plan is hazardous{why}",
            where=f"plan '{plan.name}'",
            fix="authorise it with --confirm 'YOUR NAME'; the report prints the name",
        )


def channels_of(plan: Plan) -> list[str]:
    """What the criteria of a plan are computed from."""
    channels = (getattr(criterion.metric, "channel", None) for criterion in plan.criteria)
    return list(dict.fromkeys(name for name in channels if isinstance(name, str)))


def rehearsed(plan: Plan, bench: BenchFile, model: Model | None = None) -> Rehearsal:
    """All steps and end steps, rehearsed; `model` is in place of the simulated bench's own.

    Raises:
        BadInputError: the plan asks for more than the bench allows.
    """
    rehearsal = Rehearsal(bench, model)
    for step in (*plan.steps, *plan.finally_):
        step.execute(rehearsal)
    return rehearsal


class Rehearsal:
    """A `Conductor` that only compares what is asked for with the bench's limits."""

    sample_time_s = TICK_S

    def __init__(self, bench: BenchFile, model: Model | None = None) -> None:
        self._bench, self._model = bench, model
        self._has_controller = False
        #: Files that analysis steps make.
        self.made: set[str] = set()
        self.prompts: list[str] = []

    def set_controller(self, file: Path) -> None:
        """The file must be readable and within the torque limit, or be made by an earlier step."""
        if not file.is_absolute() and file.name in self.made:
            self._has_controller = True
            return
        if not file.is_absolute() and not file.is_file():
            raise BadInputError(
                f"no earlier step makes '{file}'",
                where="plan",
                fix="put the design step before set_controller",
            )
        self.take(load_controller(file), str(file))

    def take(self, controller: Controller, where: str) -> None:
        """What a controller may ask for must be within the torque limit; `where` names it in messages."""
        limit = self._bench.limits.motor_torque_nm
        if controller.torque_limit_nm > limit:
            raise BadInputError(
                f"torque_limit_nm = {controller.torque_limit_nm:g} is above the bench's {limit:g} N m",
                where=where,
                fix="lower it; a bench's limits cannot be raised from a plan",
            )
        self._has_controller = True

    def hold_speed(self, speed_m_s: float, duration_s: float) -> None:
        """The speed must be within the limit."""
        del duration_s
        limit = self._bench.limits.vehicle_speed_m_s
        if abs(speed_m_s) > limit:
            raise BadInputError(
                f"hold_speed requests {speed_m_s * 3.6:g} km/h, the bench allows {limit * 3.6:g} km/h",
                where="plan",
                fix="lower speed_km_h; a bench's limits cannot be raised from a plan",
            )

    def set_slip(self, slip: float) -> None:
        """Nothing to compare."""

    def set_vehicle(self, vehicle: VehicleAndRoad) -> None:
        """There must be a device that may take it, and where the bench is simulated tyres that slide."""
        if not self._bench.devices:
            raise BadInputError(
                "set_vehicle: the bench has no device that accepts vehicle and road load",
                where="plan",
                fix='give the bench file a panel: [devices.panel] with kind = "rcs-panel"',
            )
        simulation = self._bench.simulation
        if simulation is None or (vehicle.friction_left, vehicle.friction_right) == (None, None):
            return
        model = self._model or load_model(simulation.model)
        if not any(use.id == "tyre_friction" for use in model.effects):
            raise BadInputError(
                "set_vehicle: friction is set, and the tyres of the bench's model hold whatever the road is",
                where="plan",
                fix='add [[effects]] id = "tyre_friction" to the model of the bench, or take sim_road',
            )

    def release_vehicle(self) -> None:
        """Nothing to compare."""

    def play(self, quantity: Quantity, samples_nm: Array, segment: PlannedSegment | None) -> None:
        """The request must be within the limit; driving torque needs a controller."""
        limits = self._bench.limits
        limit = limits.motor_torque_nm if quantity == "motor_torque" else limits.driving_torque_nm
        largest = float(np.max(np.abs(samples_nm)))
        name = f"plan, segment '{segment.id}'" if segment else "plan"
        if largest > limit:
            raise BadInputError(
                f"requests {largest:g} N m of {quantity.replace('_', ' ')}, the bench allows {limit:g} N m",
                where=name,
                fix="lower the amplitude; a bench's limits cannot be raised from a plan",
            )
        if quantity == "driving_torque" and not self._has_controller:
            raise BadInputError(
                "requests driving torque before any set_controller step",
                where=name,
                fix="set a controller first",
            )

    def coast(self, duration_s: float) -> None:
        """Nothing to compare."""

    def wait(self, duration_s: float) -> None:
        """Nothing to compare."""

    def prompt(self, text: str, timeout_s: float = PROMPT_TIMEOUT_S, picture: str = "") -> None:
        """Remember what the operator will be asked."""
        del timeout_s, picture
        self.prompts.append(text)

    def ramp_down(self, duration_s: float) -> None:
        """Nothing to compare."""

    def analyse(self, name: str, work: Work, makes: tuple[str, ...]) -> None:
        """Remember what will be there."""
        del name, work
        self.made.update(makes)
