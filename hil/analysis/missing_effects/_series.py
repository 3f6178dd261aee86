"""Recordings on even time grids: what a hypothesis is simulated on and compared with."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from hil.analysis.frequency_response import period_samples
from hil.analysis.missing_effects._spectrum import edges_hz, powers_of
from hil.analysis.spikes import without_spikes
from hil.analysis.stretches import (
    LEAST_DURATION_S,
    LEAST_SAMPLES,
    excerpts,
    unbroken,
    without,
)
from hil.core.channels import ANGLES, ANY_OUTPUT, CHANNELS, INPUT, OUTPUTS, WHEEL_ANGLE, read_from
from hil.core.errors import BadInputError
from hil.core.errors.wording import closest
from hil.core.model import Model
from hil.core.recording import Recording
from hil.plant import (
    TURNED_OVER_S,
    Turning,
    angle_at,
    at_true_times,
    by_angle,
    even_times,
    given_outputs,
    half_window,
    held_over,
    is_regulated,
    jittered,
    load_of,
    speed_of,
    stands,
    turned,
    turning_of,
)

Array = npt.NDArray[np.float64]

FIT_RATE_HZ = 250.0
"""Errors are averaged down to this rate: twice the bandwidth of anything mechanical in an axle."""
_SLOWEST_S = 0.02  # a recording sampled more slowly is refused
_EVEN_SHARE = 0.05  # of a sample, by which stamps may be off their grid and still be taken as they are
_ALIKE = 0.01  # of a sample, by which clocks may differ
_USUAL = 0.95  # of the steps between uneven stamps are at most as long as a block
_EXCITED = 1e-2  # of the octave that a periodic torque excites most, for an octave that it excites at all
_RESTS_S = 0.1  # at least is a rest; a speed that passes zero is none
_FIRST_SAMPLES = 5  # whose mean is the first guess of where a recording begins


@dataclass(frozen=True)
class Series:
    """One stretch of a recording; `source` is its file, `notes` are what was done to its readings.

    `torque` is held over samples of `dt` seconds; `samples` (n x 3, in the order of `OUTPUTS`) has NaN where
    a channel was not recorded; `measured` (blocks x 3) are means of `block` samples, NaN also where a channel
    is `given` to the model (its wheels turn as recorded); `load` brakes the wheels in N m, None where the
    model takes none. `even`: samples are readings, else interpolated between them. A speed may have been
    recorded as an `angle` (n x 3, rad; NaN where not): then it is what that turns by around each sample
    (`hil.plant.speed_of`). What was put on the grid of others stands `as_sampled` beside it.
    """

    name: str
    torque: Array
    dt: float
    block: int
    samples: Array
    measured: Array
    load: Array | None
    first_wheel_angle_rad: float
    notes: tuple[str, ...]
    even: bool = True
    given: npt.NDArray[np.bool_] = field(default_factory=lambda: np.zeros(len(OUTPUTS), dtype=bool))
    angle: Array = field(default_factory=lambda: np.full((1, len(OUTPUTS)), np.nan))
    source: str = ""
    as_sampled: Series | None = None

    @property
    def has(self) -> npt.NDArray[np.bool_]:
        """Which channels were recorded to be compared, shape (3,)."""
        return np.asarray(np.isfinite(self.measured[0]), dtype=bool)

    @property
    def of_angle(self) -> npt.NDArray[np.bool_]:
        """Which channels were recorded as an angle, (3,)."""
        return np.asarray(np.isfinite(self.angle[0]), dtype=bool)

    @property
    def turned_over_s(self) -> Array:
        """Within what time an angle is read in place of a speed, (3,); 0 of a speed."""
        return np.where(self.of_angle, 2 * half_window(self.dt) * self.dt, 0.0)

    @property
    def rate_hz(self) -> float:
        """Of block means."""
        return 1.0 / (self.dt * self.block)

    @cached_property
    def periods(self) -> float:
        """How many periods of a torque that repeats itself there are; one of any other."""
        period = period_samples(self.torque)
        return 1.0 if period is None else len(self.torque) / period

    @cached_property
    def lowest_hz(self) -> float:
        """Upper edge of the last octave below all that a periodic torque excites: from there errors count.

        What is not excited decides nothing: below the lines of a multisine stands what drifts. Zero where a
        torque does not repeat itself.
        """
        if self.periods == 1.0:
            return 0.0
        count = len(self.measured)
        torque = self.torque[: count * self.block].reshape(count, self.block).mean(axis=1)[:, None]
        power = powers_of([torque - np.mean(torque)], self.rate_hz, np.ones(1)).power.mean(axis=(0, 1))
        return float(edges_hz(self.rate_hz)[np.argmax(power > _EXCITED * np.max(power))])

    def first_state(self, gear_ratio: float) -> Array:
        """A first guess of motor speed, wheel speed and shaft torque, no motion inside a tyre: (5,)."""
        motor, wheel, shaft = self.samples[:_FIRST_SAMPLES].mean(axis=0)
        if self.given[1]:
            wheel = self.turning(gear_ratio).speed[0]
        if self.given[0]:
            motor = wheel * gear_ratio
        if not np.isfinite(motor):
            motor = wheel * gear_ratio
        if not np.isfinite(wheel):
            wheel = motor / gear_ratio
        return np.asarray(np.nan_to_num(np.array([motor, wheel, shaft, 0.0, 0.0])), dtype=float)

    def turning(self, gear_ratio: float) -> Turning:
        """What the wheels do, by the motor's channel where they have none themselves."""
        return self._turning if np.isfinite(self.samples[0, 1]) else self._turning.geared(gear_ratio)

    @cached_property
    def _turning(self) -> Turning:
        """What the side does whose motion is given: asked for at every first guess of a start."""
        column = 1 if np.isfinite(self.samples[0, 1]) else 0
        if self.of_angle[column]:
            return turning_of(self.angle[:, column], self.dt, 2)
        return turning_of(self.samples[:, column], self.dt)

    def angles(self, gear_ratio: float) -> Array:
        """Wheel and rotor angle in rad at every sample (n x 2), integrated from the recorded speeds."""
        return turned(self.samples, self.dt, gear_ratio, self.first_wheel_angle_rad)


def series_of(model: Model, recordings: Sequence[Recording], period_s: float = 0.0) -> list[Series]:
    """The unbroken stretches of all recordings on even grids, with means over the same time.

    A grid is a recording's own where as many of its samples make that time as those of others do.

    Args:
        period_s: of means, where others beside these have given it.

    Raises:
        BadInputError: no torque request, none of the model's outputs, too short, too slowly sampled, or no
        load that the model takes.
    """
    pieces = []
    for recording in (_comparable(model, one) for one in recordings):
        for part in unbroken(recording, model.load_input):
            pieces += [piece for whole in excerpts(part) for piece in _moving(model, whole)]
    for piece in pieces:
        _refuse_too_little(piece)
    timed = [_timed(piece) for piece in pieces]
    coarsest = max((dt for *_, dt in timed), default=1.0 / FIT_RATE_HZ)
    period_s = period_s or coarsest * _samples_in_a_mean(coarsest)
    found = [_series(model, *one, period_s) for one in timed]
    if is_regulated(model) and not any(one.has.any() for one in found):
        raise BadInputError(
            "the recordings have nothing beside the speed that the wheels are held at",
            where=", ".join(str(one.source) for one in recordings),
            fix="record the shaft torque, or of an axle with shafts the motor's speed",
        )
    if not any(one.has.any() for one in found):
        raise BadInputError(
            f"the recordings have none of {', '.join(ANY_OUTPUT)}", fix="record at least a speed"
        )
    return found


def _moving(model: Model, recording: Recording) -> list[Recording]:
    """Where a motor on a flange turns: held at rest, its friction may be anything up to what holds it."""
    if not (is_regulated(model) and model.kind == "rigid"):
        return [recording]
    return without(recording, stands(model, recording), _RESTS_S)


def _comparable(model: Model, recording: Recording) -> Recording:
    """The recording without outputs that a transfer-function model has no function for; a note says so."""
    measured = read_from(recording)
    lacking = [channel for name, channel in measured.items() if name not in model.transfer_functions]
    if not (model.transfer_functions and lacking):
        return recording
    if len(lacking) == len(measured):
        raise BadInputError(
            f"the model has no function for any of its outputs: {', '.join(measured.values())}",
            where=str(recording.source),
            fix="add [transfer_functions] of one of them to the model file, or record what the model shows",
        )
    notes = [*recording.notes, f"the model has no function for {', '.join(lacking)}: not compared"]
    return replace(recording.without(lacking), notes=notes)


def _refuse_too_little(recording: Recording) -> None:
    where, lasts_s = str(recording.source), float(recording.time_s[-1] - recording.time_s[0])
    if recording.samples < LEAST_SAMPLES:
        raise BadInputError(
            f"has {recording.samples} samples, a diagnosis needs {LEAST_SAMPLES}",
            where=where,
            fix="record longer",
        )
    if recording.sample_time_s > _SLOWEST_S:
        raise BadInputError(
            f"is sampled every {recording.sample_time_s * 1e3:g} ms: too slow for a driveline",
            where=where,
            fix="record at 100 Hz or more, best at 1 kHz; or is time_s in another unit?",
        )
    if lasts_s < LEAST_DURATION_S:
        raise BadInputError(
            f"lasts {lasts_s:.3g} s, a diagnosis needs {LEAST_DURATION_S:g} s",
            where=where,
            fix="record longer; or is time_s in another unit?",
        )


def _notes(recording: Recording, uneven: str, dt: float) -> list[str]:
    """What was done to a recording's readings, and which channels may have been meant to be read."""
    strange = [name for name in recording.channels if name not in CHANNELS]
    there = read_from(recording)
    notes = [
        f"has no {channel}, and '{near}' is not used: if it is that, rename it"
        for channel in OUTPUTS
        if channel not in there and (near := closest(channel, strange))
    ]
    if dt > 1.0 / FIT_RATE_HZ:
        notes.append(
            f"sampled at {1.0 / dt:.4g} Hz: what the torque did between samples is not known, and looks like "
            f"up to {0.5e3 * dt:.3g} ms of dead time"
        )
    if uneven:
        notes.append(f"{uneven}: put on a grid of {dt * 1e3:.4g} ms")
    notes += [
        f"{name} is what {angle} turns by within {TURNED_OVER_S * 1e3:g} ms"
        for name, angle in there.items()
        if name != angle
    ]
    return notes


def _timed(recording: Recording) -> tuple[Recording, Array, float]:
    """A stretch at the times of its clock, its own even times, and how far these are apart."""
    true = at_true_times(recording)
    grid, dt = even_times(true.time_s)
    if true is not recording:
        true = replace(true, notes=[*true.notes, jittered(dt)])
    return true, grid, dt


def _samples_in_a_mean(dt: float) -> int:
    return max(1, round(1.0 / (FIT_RATE_HZ * dt)))


def _series(model: Model, recording: Recording, grid: Array, dt: float, period_s: float) -> Series:
    """A stretch on its own even times, `dt` apart, or on such as make the means that others have."""
    time, block = recording.time_s, max(1, math.floor(period_s / dt * (1.0 + _ALIKE)))
    is_other = abs(block * dt - period_s) > _ALIKE * period_s
    as_sampled = _series(model, recording, grid, dt, dt * _samples_in_a_mean(dt)) if is_other else None
    if is_other:
        dt = period_s / block
        grid = np.arange(time[0], time[-1], dt)
    nearest = np.clip(np.searchsorted(time, grid - 0.5 * dt), 0, len(time) - 1)
    even = bool(np.max(np.abs(time[nearest] - grid)) <= _EVEN_SHARE * dt) and not is_other
    uneven = "sampled at another rate" if is_other else "" if even else "time stamps are uneven"

    def on_grid(values: Array) -> Array:
        return np.asarray(values[nearest] if even else np.interp(grid, time, values), dtype=float)

    samples, angle = np.full((2, len(grid), len(OUTPUTS)), np.nan)
    of_angle, notes = by_angle(recording), [*recording.notes, *_notes(recording, uneven, dt)]
    for column, name in enumerate(OUTPUTS):
        if of_angle[column]:
            angle[:, column] = angle_at(recording, ANGLES[name], grid)
            samples[:, column] = speed_of(angle[:, column], dt)
        elif name in recording:
            samples[:, column], note = without_spikes(on_grid(recording[name]), name, dt)
            notes += [note] if note else []
    if not even:  # a block without a reading of its own would show what was interpolated
        block = max(block, math.ceil(float(np.quantile(np.diff(time), _USUAL)) / dt))
    torque = recording[INPUT][nearest] if even else held_over(grid, dt, time, recording[INPUT])
    torque = np.ascontiguousarray(torque, dtype=float)
    load, given = load_of(model, recording), given_outputs(model)
    return Series(
        recording.source.stem,
        torque,
        dt,
        block,
        samples,
        np.where(given, np.nan, block_means(samples, block)),
        None if load is None else on_grid(load),
        float(recording[WHEEL_ANGLE][0]) if WHEEL_ANGLE in recording else 0.0,
        tuple(notes),
        even,
        given,
        angle,
        str(recording.source),
        as_sampled,
    )


def block_means(samples: Array, block: int) -> Array:
    """Means of `block` rows each; what does not fill a block is left out."""
    count = len(samples) // block
    return np.asarray(samples[: count * block].reshape(count, block, -1).mean(axis=1))
