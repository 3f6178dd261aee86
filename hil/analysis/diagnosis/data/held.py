"""Channels that hold a value, throughout or for a while, as the axle goes on moving: dead, clipped or frozen.

Standing still is no fault of a channel: dry friction holds a rotor, a dyno holds a wheel. But motor and wheel
turn by the same angle but for play and twist; where shaft torque stays, speeds change evenly; what runs
steeply into a plateau and steeply out of it did not rest; and noise does not read the same for long.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.thresholds import (
    FREEZE_WINDOWS_S,
    HOLDS_SHARE,
    LIKELIER,
    MOMENT_S,
    PLATEAU_SAMPLES,
    PLAY_RAD,
    STANDSTILL_SHARE,
    STEPS,
    TORQUE_MOVES,
    TURNS_ON,
    VISIBLE,
)
from hil.analysis.missing_effects import Series, block_means
from hil.analysis.stretches import runs
from hil.core.channels import INPUT, OUTPUTS
from hil.core.errors import BadInputError
from hil.core.model import Model
from hil.plant import gear_ratio_of, rounding_step

Array = npt.NDArray[np.float64]


def refuse_held(model: Model, series: Sequence[Series], noise: Array, beside: Sequence[Series] = ()) -> None:
    """Refuse a channel that holds a value as others go on.

    Args:
        model: its gear ratio, the stiffness of its shafts and its motor's inertia are used, roughly.
        noise: standard deviation of each output's block means, shape (3,).
        beside: other recordings of the same channels, that are not checked.

    Raises:
        BadInputError: names the channel, the recording and the stretch.
    """
    for one in series:
        of_speed = one.has & ~one.of_angle  # an encoder that rests reads the same
        for column in np.flatnonzero(of_speed).tolist():
            reading = _Reading.of(one, column)
            if reading.span == 0.0:
                others = [s for s in (*series, *beside) if s is not one and s.has[column]]
                _dead(one, column, model, noise, others)
            else:
                _same_for_long(one, column, reading)
                _clipped(one, column, reading)
        _frozen(one, noise, model)


@dataclass(frozen=True)
class _Reading:
    """Readings of a channel: how far levels are apart, how far they go, runs of the same (begin, end)."""

    values: Array
    step: float
    span: float
    held: npt.NDArray[np.intp]

    @classmethod
    def of(cls, one: Series, column: int) -> _Reading:
        """Of a recorded channel."""
        values = one.samples[:, column]
        span = float(np.ptp(values))
        step = rounding_step(values) if len(np.unique(values)) > 2 else span
        return cls(values, step, span, runs(np.diff(values) == 0.0))

    def same(self, begin: int, end: int) -> float:
        """How often a reading is that before it, but for a stretch."""
        count = int(np.sum(self.held[:, 1] - self.held[:, 0])) - (end - begin)
        return max(count, 1) / max(len(self.values) - (end - begin), 1)


def _dead(one: Series, column: int, model: Model, noise: Array, others: Sequence[Series]) -> None:
    """A channel that reads one value: a speed may stand still, or move by less than its steps."""
    value = float(one.samples[0, column])
    torque = float(np.max(np.abs(one.torque)))
    if column == 2:
        dead = torque > 0.0 and any(moves(one, c, noise) for c in (0, 1))
    elif one.has[1 - column]:
        ratio = gear_ratio_of(model) or 1.0
        other = one.measured[:, 1 - column] * (ratio if column == 0 else 1.0 / ratio)
        turned = np.cumsum(other) / one.rate_hz / (ratio if column == 0 else 1.0)
        step = STEPS * np.sqrt(12.0) * noise[column] if others else 0.0
        dead = bool(np.ptp(_slow(other, one.rate_hz)) > step and np.std(around(1, turned)) > PLAY_RAD)
    else:  # alone it stands still by friction, but not under more torque than has moved it from there
        step = np.sqrt(12.0) * noise[column]
        began = [s for s in others if abs(s.samples[0, column] - value) <= step]
        moved = [s for s in began if np.ptp(s.samples[:, column]) > STEPS * step]
        dead = any(np.max(np.abs(s.torque)) < torque for s in moved)
    if dead:
        raise BadInputError(
            f"{OUTPUTS[column]} looks dead: it reads {value + 0.0:g} throughout",
            where=one.source,
            fix="repair the channel, or omit it from the recording",
        )


def moves(one: Series, column: int, noise: Array) -> bool:
    """Whether a channel does more than read noise."""
    return bool(one.has[column] and np.std(one.measured[:, column]) > VISIBLE * noise[column])


def _same_for_long(one: Series, column: int, reading: _Reading) -> None:
    """Noise never reads the same for long; a channel that rests may have none."""
    if not len(reading.held):
        return
    begin, end = reading.held[np.argmax(reading.held[:, 1] - reading.held[:, 0])].tolist()
    value, same = float(reading.values[begin]), reading.same(begin, end)
    unlikely = (end - begin) * -np.log(same) > np.log(LIKELIER * len(reading.values))
    rests = max(reading.step, STANDSTILL_SHARE * float(np.max(np.abs(reading.values))))
    if same > 0.5 or not unlikely or abs(value) <= rests:  # noise below the steps; or an encoder stands still
        return
    often = np.count_nonzero(reading.values[reading.held[:, 0]] == value) > 1
    if often and value in (np.min(reading.values), np.max(reading.values)):
        raise _clipped_error(one, column, value)
    if (end - begin) * one.dt > MOMENT_S:  # less may be a telegram that was lost
        raise _frozen_error(one, column, begin, end, "")


def _clipped(one: Series, column: int, reading: _Reading) -> None:
    """Readings run steeply into a plateau at one end and steeply out of it."""
    values, reach = reading.values, PLATEAU_SAMPLES
    finest = max(reading.step, 1e-6 * reading.span)
    for end in (float(values.max()), float(values.min())):
        held = runs(values == end)
        first, last = held[(held[:, 0] >= reach) & (held[:, 1] + reach <= len(values))].T
        long = last - first > reach
        if reading.same(0, 0) > 0.5:  # rounded: what the torque does in its last samples shows only after it
            swings = [np.ptp(one.torque[a : max(b - reach, a + 1)]) for a, b in zip(first, last, strict=True)]
            long &= np.array(swings) > TORQUE_MOVES * np.ptp(one.torque)
        steep = np.minimum(np.abs(values[first - reach] - end), np.abs(values[last + reach - 1] - end))
        if np.any(long & (steep > STEPS * finest)):
            raise _clipped_error(one, column, end)


def _frozen(one: Series, noise: Array, model: Model) -> None:
    """Refuse a channel that stops for a while, exactly or with noise, as the others go on."""
    ratio = gear_ratio_of(model) or 1.0
    scale = np.array([1.0 / ratio, 1.0, 1.0])
    values = one.measured * scale
    spread = np.std(values, axis=0)
    holds = np.maximum(2.0 * noise * scale, HOLDS_SHARE * spread)
    for column in np.flatnonzero(one.has & ~one.of_angle & (spread > 5.0 * holds)).tolist():
        least = 10.0 * float(holds[column])
        for first, last in _holding(values[:, column], float(holds[column]), one.rate_hz):
            inside = slice(first, last)
            if column == 2:
                other = _on_by_torque(one, inside, ratio * one.torque, least, spread, holds)
            else:
                other = _on_by_turning(one, inside, values, 1 - column, least, model)
            if other:
                begin, end = _stretch(values[:, column], first, last, float(holds[column]))
                raise _frozen_error(one, column, begin * one.block, end * one.block, f", as {other} moves on")


def _holding(values: Array, holds: float, rate_hz: float) -> Iterator[tuple[int, int]]:
    """Windows in which a channel stays at a value."""
    for seconds in FREEZE_WINDOWS_S:
        length = round(seconds * rate_hz)
        for first in range(0, len(values) - length + 1, max(1, length // 4)):
            if np.std(values[first : first + length]) < holds:
                yield first, first + length


def _on_by_turning(one: Series, inside: slice, values: Array, other: int, least: float, model: Model) -> str:
    """The other speed, where it turns further than play and twist allow; even change may be drift."""
    # what a motor gives to its shafts: at a resonance far more than its torque
    rotor = model.parameters.get("motor_inertia", 0.0) * np.gradient(one.measured[:, 0], 1.0 / one.rate_hz)
    pulls = block_means(one.torque[:, None], one.block)[:, 0] - rotor
    part = values[inside, other]
    turned = around(2, _slow(np.cumsum(part), one.rate_hz)) / one.rate_hz
    apart = apart_rad(model, pulls[inside])
    return OUTPUTS[other] if np.std(turned) > apart and np.std(around(1, part)) > least else ""


def _on_by_torque(
    one: Series, inside: slice, torque: Array, least: float, spread: Array, holds: Array
) -> str:
    """The torque, where it moves and a speed answers by other than even change."""
    slow = _slow(block_means(torque[:, None], one.block)[inside, 0], one.rate_hz)
    if np.std(slow) < max(least, TURNS_ON * float(spread[2])):
        return ""
    scale = spread[:2] / np.maximum(np.std(one.measured[:, :2], axis=0), 1e-30)
    uneven = np.std(around(1, one.measured[inside, :2]), axis=0) * scale
    answers = uneven > np.maximum(5.0 * holds[:2], 0.2 * TURNS_ON * spread[:2])
    return INPUT if np.any(answers & one.has[:2]) else ""


def apart_rad(model: Model, torque: Array) -> float:
    """How far play and a motor's torque in N m let both sides turn apart, rms, wheel side."""
    ratio, stiffness = gear_ratio_of(model) or 1.0, model.parameters.get("shaft_stiffness", np.inf)
    return PLAY_RAD + ratio * float(np.std(torque)) / stiffness


def around(degree: int, values: Array) -> Array:
    """`values` (n,) or (n x channels) without their best polynomial of a degree."""
    at = np.linspace(-1.0, 1.0, len(values))
    trend = np.polynomial.legendre.legval(at, np.polynomial.legendre.legfit(at, values, degree))
    return np.asarray(values - trend.T)


def _slow(values: Array, rate_hz: float) -> Array:
    count = max(1, round(MOMENT_S * rate_hz))
    return np.convolve(values, np.ones(count) / count, "valid")


def _stretch(values: Array, first: int, last: int, holds: float) -> tuple[int, int]:
    """The stretch around a window that stays near its mean."""
    near = np.abs(values - np.mean(values[first:last])) < 6.0 * holds
    before, after = np.flatnonzero(~near[:first]), np.flatnonzero(~near[last:])
    return int(before[-1]) + 1 if before.size else 0, last + int(after[0]) if after.size else len(values)


def _clipped_error(one: Series, column: int, end: float) -> BadInputError:
    share = np.mean(one.samples[:, column] == end)
    return BadInputError(
        f"{OUTPUTS[column]} looks clipped at {end:g}: {share:.0%} of its samples read this",
        where=one.source,
        fix="widen the channel's range and record again",
    )


def _frozen_error(one: Series, column: int, begin: int, end: int, others: str) -> BadInputError:
    value = float(np.mean(one.samples[begin:end, column]))
    return BadInputError(
        f"{OUTPUTS[column]} looks frozen: it reads {value:.4g} from {begin * one.dt:.4g} s to "
        f"{end * one.dt:.4g} s{others}",
        where=one.source,
        fix="repair the channel, or cut this part out of the recording",
    )
