"""What must not get worse while criteria gain margin: response time, steady error, torque effort, stability.

A plan asks for what its author thought of. A search takes from everything else whatever it can have, and a
slow controller overshoots little: so these figures are held against the start's on the same car. On a car on
which the start fails the plan nothing is kept but the hard limits: what fails is to be mended first.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from hil.analysis.control_design import Margins
from hil.core.recording import Recording
from hil.core.result import Segment
from test_plans.metrics import Arrival, NotReachedError, NoValueError, TimeToTolerance

#: Margins of the plan's own criteria: what passes is not traded.
CRITERIA = "criteria"
#: What is kept, as a file and an option name it.
KEPT = ("response_time", "steady_error", "torque_effort", "stability", CRITERIA)
#: Of the speed loop: the largest value that counts, and whether more is worse.
_LOOP = {
    "sensitivity_peak": (1e3, True),
    "gain_margin_db": (40.0, False),
    "phase_margin_deg": (180.0, False),
    "delay_margin_s": (1.0, False),
}
_UNITS = {
    "response_time": "s",
    "steady_error": "%",
    "torque_effort": "N m",
    "sensitivity_peak": "",
    "gain_margin_db": "dB",
    "phase_margin_deg": "°",
    "delay_margin_s": "s",
}
_WORDS = {
    "response_time": "response time, 90 %",
    "steady_error": "steady-state error",
    "torque_effort": "torque effort",
    "sensitivity_peak": "|S|max",
    "gain_margin_db": "gain margin",
    "phase_margin_deg": "phase margin",
    "delay_margin_s": "delay margin",
}
CHANNELS = ("shaft_torque_nm", "motor_torque_ref_nm", "wheel_speed_rad_s")
_TORQUE, _REQUEST = CHANNELS[:2]
_LEAST_ERROR = 0.5  # % of the step: a steady error below that is none
_LONGEST_MEAN_S, _MEAN_SHARE = 2.0, 0.25
_SHOWN = 1e-3  # a smaller share is the same


@dataclass(frozen=True)
class Kept:
    """One figure: `name` of those that are kept, and the segment, '' for the speed loop's."""

    name: str
    segment: str = ""

    @property
    def unit(self) -> str:
        """Of its value."""
        return _UNITS[self.name]

    @property
    def words(self) -> str:
        """As people read it."""
        return _WORDS[self.name] + (f", {self.segment}" if self.segment else "")

    @property
    def limit(self) -> str:
        """Its name among hard limits."""
        return f"keep.{self.name}" + (f".{self.segment}" if self.segment else "")

    @property
    def group(self) -> str:
        """As a file and an option name it."""
        return "stability" if self.name in _LOOP else self.name

    def worse_by(self, start: float, value: float) -> float:
        """By which share a value is worse than the start's; negative: better.

        A response that never comes is infinitely late: no worse than another that never comes.
        """
        if not np.isfinite(start):
            return 0.0 if not np.isfinite(value) else -1.0
        if not np.isfinite(value):
            return np.inf
        change = (value - start) if _LOOP.get(self.name, (0.0, True))[1] else (start - value)
        least = _LEAST_ERROR if self.name == "steady_error" else 1e-9
        if self.name == "steady_error":
            change = max(value, least) - max(start, least)
        return float(change / max(abs(start), least))


@dataclass(frozen=True)
class Worse:
    """A figure that is worse than with the start, on the car on which it is worst by the largest share."""

    words: str
    unit: str
    start: float
    value: float
    share: float
    car: int


def kept_in(segments: Iterable[str]) -> tuple[Kept, ...]:
    """Every figure that driven segments and the speed loop may have."""
    of_run = [name for name in _UNITS if name not in _LOOP]
    return (*(Kept(name, id_) for id_ in segments for name in of_run), *map(Kept, _LOOP))


def kept_of_loop(loop: Margins) -> dict[Kept, float]:
    """Margins of a speed loop; one without bound counts as the largest that does."""
    return {Kept(name): float(min(getattr(loop, name), most)) for name, (most, _) in _LOOP.items()}


def kept_of_run(recording: Recording, segments: Iterable[Segment]) -> dict[Kept, float]:
    """Figures of every step of driving torque; a response that never comes is infinitely late.

    Response time: 90 % of the step. Steady error: mean at the end, of the step's size, its magnitude.
    Torque effort: root mean square of T_m* after the step, less its mean at the end: what is done beyond
    holding the torque.
    """
    found: dict[Kept, float] = {}
    for segment in segments:
        if segment.reference_before == segment.reference_after or segment.quantity != "driving_torque":
            continue
        mean_s = min(_LONGEST_MEAN_S, _MEAN_SHARE * (segment.end_s - segment.step_s))
        try:
            late_s = TimeToTolerance(channel=_TORQUE).compute(recording, segment)
        except NotReachedError:
            late_s = np.inf
        except NoValueError:
            continue
        found[Kept("response_time", segment.id)] = late_s
        error = Arrival(channel=_TORQUE, mean_s=mean_s).compute(recording, segment)
        found[Kept("steady_error", segment.id)] = abs(error)
        rows = slice(*np.searchsorted(recording.time_s, (segment.step_s - 1e-6, segment.end_s - 1e-6)))
        request = recording[_REQUEST][rows]
        held = float(np.mean(request[-max(1, round(mean_s / recording.sample_time_s)) :]))
        found[Kept("torque_effort", segment.id)] = float(np.sqrt(np.mean((request - held) ** 2)))
    return found


def room(
    figures: Mapping[Kept, float], start: Mapping[Kept, float], share: float, may_worsen: Iterable[str]
) -> dict[str, float]:
    """What is left until a figure is worse than the start's by more than `share`, by the limit's name."""
    free = set(may_worsen)
    return {
        one.limit: share - one.worse_by(start[one], value)
        for one, value in figures.items()
        if one.group not in free and one in start
    }


def margin_room(
    margins: Mapping[str, float], start: Mapping[str, float], share: float, may_worsen: Iterable[str]
) -> dict[str, float]:
    """What is left until a criterion has lost more margin than `share`."""
    if CRITERIA in may_worsen:
        return {}
    return {margin_limit(name): share + margin - start[name] for name, margin in margins.items()}


def margin_limit(criterion: str) -> str:
    """Name of a criterion's loss of margin among hard limits."""
    return f"keep.{CRITERIA}.{criterion}"


def worse_of(
    start: Iterable[Mapping[Kept, float]], value: Iterable[Mapping[Kept, float]]
) -> tuple[Worse, ...]:
    """What is worse on some car, by falling share.

    Args:
        start, value: figures of each car, in the same order.
    """
    worst: dict[Kept, Worse] = {}
    for car, (before, after) in enumerate(zip(start, value, strict=True)):
        for one in before.keys() & after.keys():
            by = one.worse_by(before[one], after[one])
            if by > _SHOWN and (one not in worst or by > worst[one].share):
                worst[one] = Worse(one.words, one.unit, before[one], after[one], by, car)
    return tuple(sorted(worst.values(), key=lambda found: (-found.share, found.words)))
