"""Channels that are broken in themselves: dead, clipped, or without anything to see."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data.thresholds import (
    BELOW_STEPS,
    CLIPPED_SHARE,
    FEW_LEVELS,
    FROZEN_NOISY,
    FROZEN_SAMPLES,
    FROZEN_STILL,
    MOVES_NOISE,
    PLATEAU_SAMPLES,
    ROUNDED,
    SPEEDS_UP,
    STEEP,
    TORQUE_MOVES,
)
from hil.analysis.diagnosis.data.trace import Trace
from hil.analysis.stretches import runs
from hil.core.channels import INPUT, OUTPUTS
from hil.core.errors import BadInputError
from hil.plant import rounding_step

Array = npt.NDArray[np.float64]


def refuse_broken_channels(traces: list[Trace], noise: Array, beside: Sequence[Trace] = ()) -> list[str]:
    """Refuse what a fit could not use; returns a note for each recording that tells nothing.

    Args:
        noise: standard deviation of each output per sample, shape (3,).
        beside: other recordings of the same channels, that are not checked.

    Raises:
        BadInputError: names the channel and the recording.
    """
    for trace in traces:
        for column in np.flatnonzero(trace.has).tolist():
            _dead(trace, column, [*traces, *beside])
            if not trace.of_angle[column]:  # an encoder that stands still reads the same count
                _clipped(trace, column, float(noise[column]))
                _frozen(trace, column)
    moved = [_moved(trace, noise) for trace in traces]
    for trace, moves in zip(traces, moved, strict=True):
        if float(np.ptp(trace.torque)) == 0.0 and moves and not _slows_down(trace, noise):
            raise BadInputError(
                f"{INPUT} looks dead: it reads {trace.torque[0]:g} throughout, but the axle accelerates",
                where=trace.source,
                fix="repair the channel, or omit the recording",
            )
    if not any(moved):
        raise BadInputError(
            "no recording shows motion, so there is nothing to diagnose", fix="record a chirp or steps"
        )
    still = [t.name for t, moves in zip(traces, moved, strict=True) if not moves]
    return [f"{name}: no motion, not used" for name in still]


def _dead(trace: Trace, column: int, traces: list[Trace]) -> None:
    values = trace.samples[:, column]
    if float(np.ptp(values)) > 0.0 or float(np.ptp(trace.torque)) == 0.0:
        return
    if _below_resolution(trace, column, [t for t in traces if t is not trace and t.has[column]]):
        return
    raise BadInputError(
        f"{OUTPUTS[column]} looks dead: it reads {values[0] + 0.0:g} throughout",
        where=trace.source,
        fix="repair the channel, or omit it from the recording",
    )


def _below_resolution(trace: Trace, column: int, others: list[Trace]) -> bool:
    """Whether a speed that is rounded in other recordings stands still as it moves by a step or two.

    How far it moves is what the other speed says, or where there is none the impulse of the torque.
    """
    if not others or column not in (0, 1):
        return False
    elsewhere = np.concatenate([t.samples for t in others])
    step = rounding_step(elsewhere[:, column])
    if trace.has[1 - column]:
        size = np.std(elsewhere, axis=0)
        turned = float(np.ptp(trace.measured[:, 1 - column]))
        return bool(turned * size[column] < BELOW_STEPS * step * size[1 - column])
    impulses = [np.std(_impulse(t)) for t in others]
    ratios = [np.std(t.samples[:, column]) / i for t, i in zip(others, impulses, strict=True) if i > 0.0]
    moved = float(np.ptp(_impulse(trace))) * float(np.median(ratios)) if ratios else np.inf
    return bool(moved < BELOW_STEPS * step)


def _impulse(trace: Trace) -> Array:
    """What torque has given an axle by each sample, N m s."""
    return np.asarray(np.cumsum(trace.torque) * trace.dt)


def _frozen(trace: Trace, column: int) -> None:
    """A channel with noise never reads the same for long."""
    values = trace.samples[:, column]
    same = np.diff(values) == 0.0
    first, last = runs(same).T
    if not first.size or float(np.max(last - first)) < FROZEN_SAMPLES:
        return
    longest = int(np.argmax(last - first))
    begin, end = int(first[longest]), int(last[longest])
    rest = np.delete(np.diff(values), np.arange(begin, end))
    if (
        len(rest) < FROZEN_SAMPLES
        or np.mean(rest == 0.0) > FROZEN_STILL
        or np.mean(rest[1:] * rest[:-1] < 0) < FROZEN_NOISY
    ):
        return
    raise BadInputError(
        f"{OUTPUTS[column]} looks frozen: it reads {values[begin]:g} from {begin * trace.dt:.4g} s "
        f"to {end * trace.dt:.4g} s",
        where=trace.source,
        fix="repair the channel, or cut this part out of the recording",
    )


def coarse(trace: Trace, column: int) -> bool:
    """Whether a channel is rounded to so few levels that it tells neither a ratio nor a plateau."""
    return len(np.unique(trace.samples[:, column])) < FEW_LEVELS


def _clipped(trace: Trace, column: int, noise: float) -> None:
    if coarse(trace, column):
        return
    values = trace.samples[:, column]
    for end in (float(values.max()), float(values.min())):
        at_end = values == end
        share = float(np.mean(at_end))
        if share > CLIPPED_SHARE and _cut_off(values, at_end, noise, trace.torque):
            raise BadInputError(
                f"{OUTPUTS[column]} looks clipped at {end:g}: {share:.0%} of its samples read this",
                where=trace.source,
                fix="widen the channel's range and record again",
            )


def _cut_off(values: Array, at_end: npt.NDArray[np.bool_], noise: float, torque: Array) -> bool:
    """Whether readings run steeply into a plateau and steeply out of it: a signal that rests does neither.

    A rounded channel has plateaus of its own wherever the torque stays the same.
    """
    first, last = runs(at_end).T
    reach = PLATEAU_SAMPLES
    whole = (last - first > reach) & (first >= reach) & (last + reach <= len(values))
    if rounding_step(values) > ROUNDED * noise:
        # what the torque does in the last samples of a plateau shows only after it
        moves = [float(np.ptp(torque[a : max(b - reach, a + 1)])) for a, b in zip(first, last, strict=True)]
        whole &= np.array(moves) > TORQUE_MOVES * float(np.ptp(torque))
    if not whole.any():
        return False
    levels = np.unique(values)
    step = max(float(np.min(np.diff(levels))), noise, 1e-6 * float(np.ptp(values)))
    end = values[first[whole][0]]
    before = np.abs(values[first[whole] - reach] - end)
    after = np.abs(values[last[whole] + reach - 1] - end)
    return bool(np.any(np.minimum(before, after) > STEEP * step))


def _moved(trace: Trace, noise: Array) -> bool:
    """Whether any output does more than read noise."""
    for column in np.flatnonzero(trace.has).tolist():
        least = max(float(noise[column]), 1e-9) / np.sqrt(trace.block)
        if float(np.std(trace.measured[:, column])) > 1.5 * least:
            return True
    return False


def _slows_down(trace: Trace, noise: Array) -> bool:
    """Whether no speed grows in magnitude by more than noise: the axle coasts."""
    length = max(1, round(0.5 / (trace.dt * trace.block)))
    for column in (0, 1):
        if trace.has[column]:
            count = len(trace.measured) // length
            slow = np.abs(trace.measured[: count * length, column].reshape(count, length).mean(axis=1))
            least = MOVES_NOISE * float(noise[column])
            risen = slow - np.minimum.accumulate(slow)
            if count and float(np.max(risen)) > max(least, SPEEDS_UP * slow.max()):
                return False
    return True
