"""One candidate on one car: the plan's criteria by the report's own code, and the hard limits."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Protocol

import numpy as np

from hil.analysis.control_design import Margins
from hil.analysis.tuning._draws import Draw
from hil.analysis.tuning._driven import Driven
from hil.analysis.tuning._free import Free
from hil.analysis.tuning._kept import (
    CHANNELS,
    CRITERIA,
    Kept,
    kept_in,
    kept_of_loop,
    kept_of_run,
    margin_limit,
    margin_room,
    room,
)
from hil.analysis.tuning._loops import SpeedLoops
from hil.analysis.tuning._parameters import with_values
from hil.core.controller import Controller
from hil.core.errors import HilError
from hil.core.model import Model
from hil.core.recording import Recording
from hil.core.result import CriterionResult, Segment
from test_plans import Plan, judge
from test_plans.criteria import Criterion

#: Prefix of the hard limits that are checks of what any device must do.
DEVICE_LIMIT = "device."

#: Prefix of the hard limits that are largest magnitudes of a whole run, by channel.
ENVELOPE_LIMIT = "envelope."
#: Of such a magnitude: a run with noise, or predicted in finer steps, may show more.
_ENVELOPE_ROOM = 0.01

#: What a candidate counts that keeps no hard limit, and one that cannot be run at all.
INFEASIBLE, UNSTABLE = -2.0, -20.0
_LEAST = -1.9  # what a margin counts at least: any candidate within the hard limits is better than one beyond
#: Of the mean margin in what is searched for: of controllers that are nearly equal in the worst margin, the
#: one with more elsewhere is better.
MEAN_SHARE = 0.05


def counted(margin: float) -> float:
    """What a margin counts in a search: itself, but from -1 to -1.9 where more than the limit is lacking."""
    return margin if margin >= -1.0 else _LEAST + (1.0 + _LEAST) / margin


class Predicted(Protocol):
    """What a run would record."""

    @property
    def recording(self) -> Recording:
        """Its channels."""

    @property
    def segments(self) -> tuple[Segment, ...]:
        """Its segments."""


class CarryOut(Protocol):
    """Carries a plan out with a controller in place of one of its files; must be picklable."""

    def __call__(
        self, model: Model, controller: Controller | None, noise: float, seed: int, *, whole: bool = False
    ) -> Predicted:
        """Predict the run: `noise` times that of the bench's sensors; `whole`: every channel."""


@dataclass(frozen=True)
class Tried:
    """What one candidate came to on one car.

    Attributes:
        values: of the free parameters.
        draw: number of the car; 0 is the model itself.
        criteria: those that depend on the controller; empty where nothing was run.
        margins: weighted margins of the criteria by id; positive is good.
        limits: (limit - value)/limit of each hard limit by name; negative is beyond it.
        loop: margins of the speed loop.
        figures: what must not get worse than the start's; those of the run only where it was run.
        device: margins of what any device must do in the driven segments, by the check's id.
        trouble: why nothing was run.
    """

    values: Mapping[str, float]
    draw: int
    loop: Margins
    limits: Mapping[str, float]
    criteria: tuple[CriterionResult, ...] = ()
    margins: Mapping[str, float] = field(default_factory=dict)
    trouble: str = ""
    figures: Mapping[Kept, float] = field(default_factory=dict)
    device: Mapping[str, float] = field(default_factory=dict)

    @property
    def feasible(self) -> bool:
        """Whether it was run and keeps every hard limit."""
        return bool(self.margins) and min(self.limits.values(), default=0.0) >= 0.0

    @property
    def worst(self) -> float:
        """The least weighted margin; what is beyond a hard limit is worse than any margin."""
        beyond = sum(max(-2.0, min(0.0, share)) for share in self.limits.values())
        if not self.margins:
            return (INFEASIBLE if self.loop.stable and not self.trouble else UNSTABLE) + beyond
        least = max(_LEAST, min(self.margins.values()))
        return least if self.feasible else INFEASIBLE + beyond

    @property
    def score(self) -> float:
        """What a search makes as large as it can: the worst margin and, for a twentieth, the mean of all."""
        if not self.feasible:
            return self.worst
        least = [counted(margin) for margin in self.margins.values()]
        return float(min(least) + MEAN_SHARE * np.mean(least))

    @property
    def binding(self) -> str:
        """The criterion with the least margin."""
        return min(self.margins, key=lambda name: self.margins[name], default="")


@dataclass(frozen=True)
class Trial:
    """Everything that a candidate is tried with; goes to other processes as it is.

    `envelope` has largest magnitudes by channel that somebody consented to: hard limits of the whole run.
    """

    plan: Plan
    driven: Driven
    free: Free
    start: Controller
    draws: tuple[Draw, ...]
    loops: SpeedLoops
    execute: CarryOut
    envelope: Mapping[str, float] = field(default_factory=dict)
    _known: dict[int, Tried] = field(default_factory=dict, repr=False, compare=False)

    def controller(self, values: Mapping[str, float], name: str = "tuned") -> Controller:
        """The start with `values` in place of its own."""
        return with_values(self.start, values, name)

    def on(self, numbers: Sequence[int]) -> Trial:
        """The same on some of the cars alone, which are numbered anew in this order."""
        draws = tuple(replace(self.draws[number], number=new) for new, number in enumerate(numbers))
        return replace(self, draws=draws, loops=self.loops.of(numbers), _known={})

    def tried(self, values: Mapping[str, float], number: int) -> Tried:
        """A candidate on car `number`; nothing is run where the loop alone is beyond the limits."""
        controller, draw = self.controller(values), self.draws[number]
        loop = self.loops.margins(controller, number)
        figures = kept_of_loop(loop)
        hard = self._loop_limits(loop)
        limits = hard | (self._room(figures, number) if self._keeps(values, number) else {})
        if not loop.stable or min(hard.values(), default=0.0) < 0.0:
            return Tried(values, number, loop, limits, figures=figures)
        try:
            found = self.execute(draw.model, controller, draw.noise, draw.seed)
        except HilError as error:
            return Tried(values, number, loop, limits, trouble=str(error), figures=figures)
        limits |= self._run_limits(found)
        everything = judge(self._judging, found.recording, found.segments, measured=False)
        criteria = tuple(one for one in everything if one.source == "plan")
        margins = self.margins_of(criteria)
        device = self._device_margins(everything)
        limits |= self._device_room(device, number if values else None)
        of_run = self._kept_of(found)
        figures |= of_run
        if not values:  # the start itself
            limits |= room(of_run, of_run, *self._keep) | margin_room(margins, margins, *self._keep)
        elif self._keeps(values, number):
            limits |= self._room(of_run, number)
            limits |= margin_room(margins, self._starts(number).margins, *self._keep)
        if self.free.limits.no_worse_than_start and values:
            own = self._starts(number).margins
            limits["no_worse_than_start"] = min(
                margin - own.get(id_, -1.0) for id_, margin in margins.items()
            )
        return Tried(values, number, loop, limits, criteria, margins, figures=figures, device=device)

    def _starts(self, number: int) -> Tried:
        """The start on a car; tried once in each process."""
        if number not in self._known:
            self._known[number] = self.tried({}, number)
        return self._known[number]

    def _keeps(self, values: Mapping[str, float], number: int) -> bool:
        """Whether anything is kept on a car: one on which the start fails is to be mended first."""
        return not values or min(self._starts(number).margins.values(), default=-1.0) >= 0.0

    @property
    def _keep(self) -> tuple[float, tuple[str, ...]]:
        return self.free.keep.share_percent / 100, self.free.keep.may_worsen

    def _room(self, figures: Mapping[Kept, float], number: int) -> dict[str, float]:
        """What is left until they are worse than the start's by more than may be."""
        of_loop = all(not one.segment for one in figures)
        start = (
            kept_of_loop(self.loops.margins(self.start, number)) if of_loop else self._starts(number).figures
        )
        return room(figures, start, *self._keep)

    def _kept_of(self, found: Predicted) -> dict[Kept, float]:
        """Of the steps that the controller drives."""
        driven = [segment for segment in found.segments if segment.id in self.driven.segments]
        return kept_of_run(found.recording, driven)

    def judged(self, found: Predicted) -> tuple[CriterionResult, ...]:
        """The criteria that depend on the controller."""
        return judge(self._judging, found.recording, found.segments, measured=False, device=False)

    @cached_property
    def _judging(self) -> Plan:
        """The plan with the criteria alone that depend on the controller."""
        return self.plan.model_copy(update={"criteria": self.driven.criteria})

    def _device_margins(self, criteria: Iterable[CriterionResult]) -> dict[str, float]:
        """Of what any device must do in the driven segments, where it was judged."""
        checks = {one.id for one in self.device_checks}
        found = (one for one in criteria if one.source == "device" and one.id in checks)
        return {
            one.id: -1.0 if one.margin is None else one.margin for one in found if one.verdict != "not_judged"
        }

    def _device_room(self, margins: Mapping[str, float], number: int | None) -> dict[str, float]:
        """What is left until a check fails; of one that the start fails, until it is worse than that.

        Args:
            number: of the car; None for the start itself.
        """
        if number is None:
            return {device_limit(id_): max(margin, 0.0) for id_, margin in margins.items()}
        start, share = self._starts(number).device, self._keep[0]
        return {
            device_limit(id_): margin if start.get(id_, 0.0) >= 0.0 else share + margin - start[id_]
            for id_, margin in margins.items()
        }

    @cached_property
    def device_checks(self) -> tuple[Criterion, ...]:
        """What any device must do in the segments that the controller drives."""
        return tuple(one for one in self._judging.device_criteria if one.segment in self.driven.segments)

    def margins_of(self, criteria: Iterable[CriterionResult]) -> dict[str, float]:
        """Weighted margins by id of those `criteria` that depend on the controller, predicted or measured."""
        known = {criterion.id: criterion for criterion in criteria}
        return {
            one.id: self._weighted(known[one.id], one.metric.name)
            for one in self.driven.criteria
            if one.id in known
        }

    def _weighted(self, criterion: CriterionResult, metric: str) -> float:
        """Its margin: with a weight of 2 what is left counts half and what is lacking double."""
        margin = criterion.margin
        if margin is None or criterion.verdict in ("error", "not_judged", "did_not_settle"):
            return 0.0 if criterion.verdict in ("pass", "informational") else -1.0
        weight = self.free.weight(criterion.id, metric)
        return margin / weight if margin > 0 else margin * weight

    @property
    def limits(self) -> tuple[str, ...]:
        """Names of the hard limits that are asked for."""
        asked = [name for name, value in self.free.limits if value is not None and value is not False]
        kept = [one.limit for one in self.kept if one.group not in self.free.keep.may_worsen]
        asked += [device_limit(one.id) for one in self.device_checks]
        asked += [envelope_limit(channel) for channel in self.envelope]
        if CRITERIA not in self.free.keep.may_worsen:
            kept += [margin_limit(criterion.id) for criterion in self.driven.criteria]
        return (*asked, *kept)

    @property
    def kept(self) -> tuple[Kept, ...]:
        """Every figure that must not get worse, also those that may."""
        return kept_in(self.driven.segments)

    def _loop_limits(self, loop: Margins) -> dict[str, float]:
        limits = self.free.limits
        found = {}
        if limits.sensitivity_peak is not None:
            found["sensitivity_peak"] = (
                limits.sensitivity_peak - loop.sensitivity_peak
            ) / limits.sensitivity_peak
        for name in ("gain_margin_db", "phase_margin_deg", "delay_margin_s"):
            least = getattr(limits, name)
            if least is not None:
                found[name] = (min(getattr(loop, name), 10 * least) - least) / least
        return found

    def _run_limits(self, found: Predicted) -> dict[str, float]:
        limits, shares = self.free.limits, {}
        driven = [segment for segment in found.segments if segment.id in self.driven.segments]
        if limits.motor_torque_nm is not None:
            largest = max(_largest_torque_nm(found.recording, segment) for segment in driven)
            shares["motor_torque_nm"] = (limits.motor_torque_nm - largest) / limits.motor_torque_nm
        if limits.motor_energy_j is not None:
            most = max(_motor_energy_j(found.recording, segment) for segment in driven)
            shares["motor_energy_j"] = (limits.motor_energy_j - most) / limits.motor_energy_j
        for name, limit in self.envelope.items():
            largest = float(np.max(np.abs(found.recording[name]), initial=0.0))
            shares[envelope_limit(name)] = 1.0 - _ENVELOPE_ROOM - largest / limit
        return shares


def device_limit(check: str) -> str:
    """Name of a device check among hard limits."""
    return f"{DEVICE_LIMIT}{check}"


def envelope_limit(channel: str) -> str:
    """Name of a channel's largest magnitude among hard limits."""
    return f"{ENVELOPE_LIMIT}{channel}"


def _inside(recording: Recording, segment: Segment) -> slice:
    first, last = np.searchsorted(recording.time_s, (segment.start_s - 1e-6, segment.end_s + 1e-6))
    return slice(int(first), int(last))


def _largest_torque_nm(recording: Recording, segment: Segment) -> float:
    part = recording["motor_torque_ref_nm"][_inside(recording, segment)]
    return float(np.max(np.abs(part), initial=0.0))


def _motor_energy_j(recording: Recording, segment: Segment) -> float:
    """Positive work of the motor in a segment."""
    part = _inside(recording, segment)
    power = recording["motor_torque_nm"][part] * recording["motor_speed_rad_s"][part]
    return float(np.sum(np.maximum(power, 0.0)) * recording.sample_time_s)


def channels_needed(criteria: Iterable[Criterion], free: Free) -> frozenset[str]:
    """Channels that criteria, those of the device among them, and hard limits are computed from."""
    names = {*CHANNELS, *(name for criterion in criteria for name in criterion.metric.channels)}
    if free.limits.motor_torque_nm is not None:
        names.add("motor_torque_ref_nm")
    if free.limits.motor_energy_j is not None:
        names |= {"motor_torque_nm", "motor_speed_rad_s"}
    return frozenset(names)
