"""Play: how long the gears lie on no flank, and how hard the next flank is met."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
from pydantic import Field, model_validator

from hil.core.recording import Recording
from hil.core.result import Segment
from test_plans.conductor import Array, PlannedSegment
from test_plans.metrics._metric import ChannelName, NotReachedError, NoValueError
from test_plans.metrics._samples import cut
from test_plans.metrics._window import WindowMetric

_MOTOR, _WHEEL = "motor_speed_rad_s", "wheel_speed_rad_s"
AFTER_CONTACT_S = 0.05  # in which the blow is over


@dataclass(frozen=True)
class Contact:
    """When a flank is met firmly, on the recording's time; `left_s`: when the other was left, if it was."""

    contact_s: float
    left_s: float | None
    sign: float


class _InPlay(WindowMetric):
    """What is read from T_s around its passage from one flank to the other.

    Shafts that are free still carry what their damping makes of the speed at which the play closes. Firm is
    more than that: a tenth of the step.
    """

    never_negative: ClassVar[bool] = True
    channel: ChannelName = "shaft_torque_nm"
    firm_percent: float = Field(
        default=10.0, gt=0, le=100, description="torque of a firm contact, % of the step's size"
    )
    firm_nm: float | None = Field(default=None, gt=0, description="torque of a firm contact instead, N m")

    @model_validator(mode="after")
    def _has_one_firm_torque(self) -> Self:
        if self.firm_nm is not None and "firm_percent" in self.model_fields_set:
            raise ValueError("'firm_nm' stands in place of 'firm_percent': give one of them")
        return self

    def contacts(self, recording: Recording, segment: Segment) -> tuple[Contact, ...]:
        """Every firm contact with another flank than the last one, in order.

        Raises:
            NoValueError: no torque of a firm contact, or samples are missing.
        """
        time, torque = self.samples(recording, segment)
        return contacts(time, torque, self._firm(segment))

    def objection(self, segment: PlannedSegment) -> str:
        """No step that gives the torque of a firm contact, or one on whose way there is no play."""
        before, after = segment.reference_before, segment.reference_after
        if before == after and self.firm_nm is None:
            return f"a {segment.kind} has no step: give 'firm_nm', or choose another metric"
        if self.since == "step" and before != after and before * after > 0:
            return f"the torque keeps its sign, {before:g} to {after:g} N m: no flank is left"
        return super().objection(segment)

    @property
    def _firmly(self) -> str:
        limit = (
            f"{self.firm_percent:g} % of the step's size" if self.firm_nm is None else f"{self.firm_nm:g} N m"
        )
        return f"firm: a magnitude of {limit} or more"

    def _firm(self, segment: Segment) -> float:
        size = abs(segment.reference_after - segment.reference_before)
        firm = self.firm_nm or self.firm_percent / 100 * size
        if firm == 0:
            raise NoValueError("the segment has no step: before and after are the same")
        return firm


class _Passage(_InPlay):
    """What needs both flanks."""

    def objection(self, segment: PlannedSegment) -> str:
        """Also where the torque begins or ends at zero: it comes from no flank, or goes to none."""
        before, after = segment.reference_before, segment.reference_after
        if self.since == "step" and before != after and before * after == 0:
            return f"the torque goes from {before:g} to {after:g} N m: it does not pass from flank to flank"
        return super().objection(segment)


class TimeInPlay(_Passage):
    """Time without firm contact on the way from one flank to the other."""

    name: ClassVar[str] = "time_in_play"

    @property
    def unit(self) -> str:
        """Seconds."""
        return "s"

    @property
    def definition(self) -> str:
        """From flank to flank."""
        return (
            f"Time from the last firm contact of {self.subject} with one flank to the first with the other "
            f"({self._firmly}), linear between samples, summed over all passages, {self.window}."
        )

    def compute(self, recording: Recording, segment: Segment) -> float:
        """Seconds; NotReachedError where the torque passes to no other flank."""
        times = [c.contact_s - c.left_s for c in self.contacts(recording, segment) if c.left_s is not None]
        if not times:  # a torque that never passes spends no time in play, which proves nothing
            raise NotReachedError(f"{self.channel} passes from no flank to the other firmly in the window")
        return float(sum(times))


class PlayCrossings(_Passage):
    """Number of passages from one flank to the other."""

    name: ClassVar[str] = "play_crossings"

    @property
    def unit(self) -> str:
        """A number."""
        return "1"

    @property
    def definition(self) -> str:
        """How often."""
        return (
            f"Number of passages of {self.subject} from firm contact with one flank to firm contact with the "
            f"other ({self._firmly}), {self.window}."
        )

    def compute(self, recording: Recording, segment: Segment) -> float:
        """The number; NotReachedError where no flank is met firmly at all."""
        (time, torque), firm_nm = self.samples(recording, segment), self._firm(segment)
        if np.max(np.abs(torque)) < firm_nm:
            raise NotReachedError(f"{self.channel} meets no flank firmly in the window")
        return float(sum(one.left_s is not None for one in contacts(time, torque, firm_nm)))


class Clunk(_InPlay):
    """Largest rate of T_s as a flank is met: what is heard and felt as a blow."""

    name: ClassVar[str] = "clunk"
    over_s: float = Field(default=0.004, gt=0, le=0.02, description="time over which the rate is taken, s")

    @property
    def unit(self) -> str:
        """Torque over time."""
        return "N m/s"

    @property
    def definition(self) -> str:
        """Where the rate is looked for."""
        return (
            f"Largest magnitude of the rate of {self.subject} over {1000 * self.over_s:g} ms, within "
            f"{1000 * AFTER_CONTACT_S:g} ms after a firm contact with another flank ({self._firmly}), "
            f"{self.window}."
        )

    def compute(self, recording: Recording, segment: Segment) -> float:
        """The largest of all contacts; NotReachedError where there is none."""
        time, torque = self.samples(recording, segment)
        found = contacts(time, torque, self._firm(segment))
        _refuse_none(found, self.channel)
        spacing_s = float((time[-1] - time[0]) / (len(time) - 1))
        apart = max(1, round(self.over_s / spacing_s))
        if len(time) <= apart:
            raise NoValueError(f"the window is shorter than {self.over_s:g} s")
        rate = np.abs(torque[apart:] - torque[:-apart]) / (time[apart:] - time[:-apart])
        # The stretch of a rate ends after the contact and begins before its 50 ms are over.
        looked = np.zeros(len(rate), bool)
        for one in found:
            looked |= (time[apart:] >= one.contact_s) & (time[:-apart] <= one.contact_s + AFTER_CONTACT_S)
        return float(np.max(rate[looked]))


class ContactEnergy(_InPlay):
    """Work that the shafts take up as a flank is met, from the two speeds."""

    name: ClassVar[str] = "contact_energy"

    @property
    def unit(self) -> str:
        """Joule."""
        return "J"

    @property
    def channels(self) -> tuple[str, ...]:
        """Torque and both speeds."""
        return (self.channel, _MOTOR, _WHEEL)

    @property
    def definition(self) -> str:
        """The integral."""
        return (
            f"Work into the shafts, the integral of {self.subject} times the speed at which they are wound "
            f"(ω_m / N - ω_l), from a firm contact with another flank ({self._firmly}) until that speed "
            f"turns around, {1000 * AFTER_CONTACT_S:g} ms at most; the largest of all "
            f"contacts, {self.window}."
        )

    def compute(self, recording: Recording, segment: Segment) -> float:
        """Joule; NoValueError without a gear ratio, NotReachedError without a contact."""
        if segment.gear_ratio is None:
            raise NoValueError("the recording gives no gear ratio, which compares the two speeds")
        start_s, end_s = self.bounds_s(recording, segment)
        time, torque = cut(recording, segment, self.channel, start_s, end_s)
        _, motor = cut(recording, segment, _MOTOR, start_s, end_s)
        _, wheel = cut(recording, segment, _WHEEL, start_s, end_s)
        found = contacts(time, torque, self._firm(segment))
        _refuse_none(found, self.channel)
        power = torque * (motor / segment.gear_ratio - wheel)
        return max(_work(time, power, one.contact_s) for one in found)


def contacts(time: Array, torque: Array, firm_nm: float) -> tuple[Contact, ...]:
    """Firm contacts with another flank than the last one; times are linear between samples.

    A torque that begins within the play meets its first flank without having left one.
    """
    firm = np.flatnonzero(np.abs(torque) >= firm_nm)
    if not firm.size:
        return ()
    sign = np.sign(torque[firm])
    found = []
    if firm[0] > 0:
        found.append(Contact(_reached(time, torque, firm[0] - 1, sign[0] * firm_nm), None, float(sign[0])))
    for place in np.flatnonzero(sign[1:] != sign[:-1]):
        left = _reached(time, torque, firm[place], sign[place] * firm_nm)
        contact = _reached(time, torque, firm[place + 1] - 1, sign[place + 1] * firm_nm)
        found.append(Contact(contact, left, float(sign[place + 1])))
    return tuple(found)


def _reached(time: Array, torque: Array, before: int, level: float) -> float:
    """When a torque reaches a level between one sample and the next."""
    rise = torque[before + 1] - torque[before]
    share = (level - torque[before]) / rise if rise else 0.0
    return float(time[before] + share * (time[before + 1] - time[before]))


def _work(time: Array, power: Array, contact_s: float) -> float:
    """Integral of a power (W) from a contact while it is positive, by trapezoids."""
    until_s = min(contact_s + AFTER_CONTACT_S, float(time[-1]))
    inside = (time > contact_s) & (time < until_s)
    at = np.array([contact_s, *time[inside], until_s])
    values = np.interp(at, time, power)
    ends = np.flatnonzero(values <= 0)
    if ends.size:
        last = int(ends[0])
        if last == 0:
            return 0.0
        share = values[last - 1] / (values[last - 1] - values[last])
        at = np.append(at[:last], at[last - 1] + share * (at[last] - at[last - 1]))
        values = np.append(values[:last], 0.0)
    return float(np.sum(0.5 * (values[1:] + values[:-1]) * np.diff(at)))


def _refuse_none(found: tuple[Contact, ...], channel: str) -> None:
    if not found:
        raise NotReachedError(f"{channel} meets no flank firmly in the window: there is no contact to judge")
