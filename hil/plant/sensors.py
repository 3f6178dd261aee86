"""Effects between the truth and the recorded channel: one law for replay, for many models and for the bench.

A sensor reads gain · lagged truth(t - delay) + offset + noise, rounded to its step. A negative delay makes a
recorded channel early; the bench, whose control acts on what it reads, cannot give that. In place of a speed
a recording may have its angle (`_angles`): then the truth is what that turns by around each sample.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from hil.core.effects import EFFECTS
from hil.core.errors import BadInputError
from hil.core.model import Model
from hil.core.runtime.compiled import compiled, inlined
from hil.plant.slots import Table

Array = npt.NDArray[np.float64]

SENSOR = Table()
_column = SENSOR.place

GAIN = _column("gain", "1", "of the reading over the truth")
OFFSET = _column("offset", "channel's", "added after the gain")
DELAY = _column("delay_s", "s", "delay of the channel")
STEP = _column("step", "channel's", "distance between readings; 0: not rounded")
LAG = _column("lag_s", "s", "time constant of a first-order low-pass; 0: none")
TURNED = _column("turned_over_s", "s", "within which an angle is read in place of a speed; 0: a speed")
COLUMNS = len(SENSOR)


@inlined
def samples_late(sensor, dt):  # type: ignore[no-untyped-def]
    """Whole samples that a reading is late (early: negative), and the part of one that remains."""
    late = sensor[DELAY] / dt
    whole = math.floor(late)
    return whole, late - whole


@inlined
def between(newer, older, part):  # type: ignore[no-untyped-def]
    """The truth a part of a sample after `older` became old."""
    return newer + part * (older - newer)


@inlined
def unrounded(truth, noise, sensor):  # type: ignore[no-untyped-def]
    """What a sensor makes of the truth at its instant, but for rounding."""
    return truth * sensor[GAIN] + sensor[OFFSET] + noise


@inlined
def reading(truth, noise, sensor):  # type: ignore[no-untyped-def]
    """What a sensor makes of the truth at its instant: scaled, shifted, noisy, rounded."""
    value = unrounded(truth, noise, sensor)
    if sensor[STEP] > 0.0:
        value = round(value / sensor[STEP]) * sensor[STEP]
    return value


@inlined
def lagged(y, before, now, lag, dt):  # type: ignore[no-untyped-def]
    """A low-pass that was at `y`, a sample on: exact where truth goes straight from `before` to `now`."""
    decay = math.exp(-dt / lag)
    mean = (1.0 - decay) * lag / dt
    return decay * y + (mean - decay) * before + (1.0 - mean) * now


@compiled
def way_of(speed):  # type: ignore[no-untyped-def]
    """Integral of a speed by samples, (n,), from zero; cubic between them."""
    last = speed.shape[0] - 1
    way = np.zeros(speed.shape[0])
    for k in range(last):
        outer = speed[max(k - 1, 0)] + speed[min(k + 2, last)]
        way[k + 1] = way[k] + (13.0 * (speed[k] + speed[k + 1]) - outer) / 24.0
    return way


@compiled
def mean_around(speed, half):  # type: ignore[no-untyped-def]
    """What the angle of a speed turns by around each sample, (n,), over time."""
    way, last = way_of(speed), speed.shape[0] - 1
    out = np.empty(speed.shape[0])
    for k in range(speed.shape[0]):
        before, after = max(k - half, 0), min(k + half, last)
        out[k] = (way[after] - way[before]) / (after - before)
    return out


@compiled
def _low_passed(truth, lag, dt):  # type: ignore[no-untyped-def]
    """Before the first sample the truth was what it is there.

    Between samples it is a curve, and straight lines between them cut its crests by (ω dt)²/12: lines between
    samples that are so much higher do not.
    """
    last = truth.shape[0] - 1
    out = np.empty(truth.shape[0])
    out[0] = before = truth[0]
    for k in range(1, truth.shape[0]):
        bend = truth[k - 1] - 2.0 * truth[k] + truth[k + 1] if k < last else 0.0
        now = truth[k] - bend / 12.0
        out[k] = lagged(out[k - 1], before, now, lag, dt)
        before = now
    return out


@compiled
def _means(truth, sensor, dt, block, out):  # type: ignore[no-untyped-def]
    last = truth.shape[0] - 1
    whole, part = samples_late(sensor, dt)
    plain = whole == 0 and part == 0.0 and sensor[STEP] <= 0.0
    for b in range(out.shape[0]):
        total = 0.0
        if plain:  # most are: what late or rounded ones ask takes half of a linear model's time
            for k in range(b * block, (b + 1) * block):
                total += unrounded(truth[k], 0.0, sensor)
            out[b] = total / block
            continue
        for k in range(b * block, (b + 1) * block):
            newer = truth[min(max(k - whole, 0), last)]
            older = truth[min(max(k - whole - 1, 0), last)]
            value = between(newer, older, part)
            if part > 0.0:  # the truth is a curve, no line
                outer = truth[min(max(k - whole + 1, 0), last)] + truth[min(max(k - whole - 2, 0), last)]
                value -= 0.25 * part * (1.0 - part) * (outer - newer - older)
            total += reading(value, 0.0, sensor)
        out[b] = total / block


@compiled
def record(truth, sensor, dt, block, out):  # type: ignore[no-untyped-def]
    """Means over `block` samples of what a sensor reads of `truth`, which holds its ends beyond them."""
    if sensor[TURNED] > 0.0 and truth.shape[0] > 1:
        truth = mean_around(truth, max(1, round(0.5 * sensor[TURNED] / dt)))
    if sensor[LAG] > 0.0 and truth.shape[0] > 0:
        _means(_low_passed(truth, sensor[LAG], dt), sensor, dt, block, out)
    else:
        _means(truth, sensor, dt, block, out)


def sensor_of(model: Model, channel: str) -> Array:
    """The row of a channel's sensor: its effects in a model together.

    Raises:
        BadInputError: the channel is rounded or low-passed twice.
    """
    row = np.zeros(COLUMNS)
    row[GAIN] = 1.0
    for use in model.effects:
        effect = EFFECTS[use.id]
        if effect.law.reads is None or use.values.get("channel") != channel:
            continue
        column = SENSOR.names.index(effect.law.reads)
        value = float(use.values[effect.parameters[0].name])
        if column == GAIN:
            row[GAIN] *= value
        elif column in (STEP, LAG) and row[column] > 0.0:
            raise BadInputError(
                f"effect '{use.id}' stands twice for '{channel}'",
                fix="keep one of the two [[effects]] tables",
            )
        else:
            row[column] += value
    return row


def sensor_response(sensors: Array, frequency_hz: Array) -> npt.NDArray[np.complex128]:
    """Response of readings to truths at frequencies, rows of `sensor_of` x frequencies; rounding left out."""
    s = 2j * np.pi * frequency_hz
    late = np.exp(-s * sensors[:, DELAY, None]) * np.sinc(frequency_hz * sensors[:, TURNED, None])
    return np.asarray(sensors[:, GAIN, None] * late / (1.0 + s * sensors[:, LAG, None]))


def bench_sensor(model: Model, channel: str, share: float = 1.0) -> Array:
    """The row of a sensor on the bench that sees `share` of a channel: 0.5 where two sides add up to it.

    Raises:
        BadInputError: the channel is early, or rounded or low-passed twice.
    """
    row = sensor_of(model, channel)
    if row[DELAY] < 0.0:
        raise BadInputError(
            f"channel_skew: '{channel}' is {-row[DELAY] * 1e3:g} ms early (delay_s = {row[DELAY]:g}), but a "
            "bench's control acts on what is read: it cannot read what has not happened",
            where="simulated bench, its model",
            fix="give a delay_s of 0 or more, or compare with hil simulate, where a channel may be early",
        )
    row[[OFFSET, STEP]] *= share
    return row


def measured(model: Model, channels: dict[str, Array], dt: float) -> dict[str, Array]:
    """The channels as the model's sensors would record them, sampled every `dt` seconds."""
    seen = dict(channels)
    ideal = sensor_of(model.with_effects(), "")
    for name, truth in channels.items():
        row = sensor_of(model, name)
        if np.any(row != ideal):
            seen[name] = np.empty(len(truth))
            record(np.ascontiguousarray(truth), row, dt, 1, seen[name])
    return seen
