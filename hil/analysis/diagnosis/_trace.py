"""A recording made ready for fits: even samples, block means, noise level, a first guess of its start."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import signal

from hil.core.channels import INPUT, OUTPUTS, WHEEL_ANGLE
from hil.core.errors import BadInputError
from hil.core.recording import Recording

Array = npt.NDArray[np.float64]

LEAST_SAMPLES = 200
_UNEVEN_SHARE = 0.01
_FIT_RATE_HZ = 250.0  # of block means: driveline modes end below 60 Hz
_FLOOR_BAND = (0.25, 0.48)  # of the sample rate: above all modes, what is left is noise
_START_SAMPLES = 20
_GAP_SAMPLES = 20.0


@dataclass(frozen=True)
class Trace:
    """One recording on an even grid.

    `measured` is blocks x 3 in the order of `OUTPUTS` (NaN where a channel is missing), each the mean of
    `block` samples; `samples` is the same at full rate; `start` is motor speed, wheel speed (rad/s) and
    shaft torque (N m) at the first sample, NaN where not measured.
    """

    name: str
    torque: Array
    dt: float
    block: int
    samples: Array
    measured: Array
    start: Array
    notes: tuple[str, ...]
    first_wheel_angle_rad: float = 0.0

    def angles(self, gear_ratio: float) -> Array:
        """Wheel and rotor angle in rad at every sample, n x 2, integrated from the measured speeds."""
        motor, wheel = self.samples[:, 0], self.samples[:, 1]
        if not self.has[1]:
            wheel = motor / gear_ratio
        if not self.has[0]:
            motor = wheel * gear_ratio
        speeds = np.column_stack([wheel, motor])
        turned = np.cumsum(0.5 * self.dt * (speeds[1:] + speeds[:-1]), axis=0)
        first = self.first_wheel_angle_rad * np.array([1.0, gear_ratio])
        return np.asarray(first + np.concatenate([np.zeros((1, 2)), turned]), dtype=float)

    @property
    def has(self) -> npt.NDArray[np.bool_]:
        """Which of the three channels were measured."""
        return np.asarray(np.isfinite(self.measured[0]))

    @property
    def block_time_s(self) -> Array:
        """Time of each block's middle from the start of the recording, s."""
        middles = np.arange(len(self.measured)) * self.block + 0.5 * (self.block - 1)
        return np.asarray(middles * self.dt, dtype=float)


def trace_of(recording: Recording, name: str = "") -> Trace:
    """Resample where time stamps are uneven, average to blocks.

    Raises:
        BadInputError: too few samples, or sampled too slowly to see a driveline.
    """
    where = str(recording.source)
    time, dt = recording.time_s, recording.sample_time_s
    if len(time) < LEAST_SAMPLES:
        raise BadInputError(f"has {len(time)} samples, a diagnosis needs {LEAST_SAMPLES}", where=where)
    if dt > 0.02:
        raise BadInputError(
            f"is sampled every {dt * 1e3:g} ms: too slow for a driveline",
            where=where,
            fix="record at 100 Hz or more, best at 1 kHz",
        )
    notes = list(recording.notes)
    grid = time
    gaps = np.diff(time)
    if np.max(np.abs(gaps - dt)) > _UNEVEN_SHARE * dt:
        grid = time[0] + dt * np.arange(int(np.floor((time[-1] - time[0]) / dt + 0.5)) + 1)
        note = f"time stamps are uneven: resampled every {dt * 1e3:g} ms"
        if gaps.max() > _GAP_SAMPLES * dt:
            note += f", with a gap of {gaps.max():.3g} s at {time[int(np.argmax(gaps))]:.3g} s bridged"
        notes.append(note)
    else:
        dt = float((time[-1] - time[0]) / (len(time) - 1))
    held = np.clip(np.searchsorted(time, grid + 1e-9 * dt, side="right") - 1, 0, len(time) - 1)
    samples = np.full((len(grid), 3), np.nan)
    for column, channel in enumerate(OUTPUTS):
        if channel in recording:
            samples[:, column] = np.interp(grid, time, recording[channel])
    block = max(1, round(1.0 / (_FIT_RATE_HZ * dt)))
    torque = np.ascontiguousarray(recording[INPUT][held])
    return Trace(
        name or recording.source.stem,
        torque,
        dt,
        block,
        samples,
        blocks(samples, block),
        _start(samples, torque),
        tuple(notes),
        float(recording[WHEEL_ANGLE][0]) if WHEEL_ANGLE in recording else 0.0,
    )


def blocks(samples: Array, block: int) -> Array:
    """Means of `block` rows each; what does not fill a block is left out."""
    count = len(samples) // block
    return np.asarray(samples[: count * block].reshape(count, block, -1).mean(axis=1))


def _start(samples: Array, torque: Array) -> Array:
    changed = np.flatnonzero(torque[:_START_SAMPLES] != torque[0])
    count = max(3, int(changed[0]) if changed.size else min(_START_SAMPLES, len(torque)))
    return np.asarray(samples[:count].mean(axis=0))


def noise_levels(traces: list[Trace]) -> Array:
    """Standard deviation of each channel's noise per sample, from the spectrum above all modes; shape (3,).

    The median over frequency and over recordings leaves out lines and blows. NaN for a channel that no
    recording has.
    """
    levels = np.full((len(traces), 3), np.nan)
    for row, trace in enumerate(traces):
        rate = 1.0 / trace.dt
        for column in np.flatnonzero(trace.has).tolist():
            length = min(1024, len(trace.samples))
            f, density = signal.welch(trace.samples[:, column], rate, nperseg=length, average="median")
            inside = (f >= _FLOOR_BAND[0] * rate) & (f <= _FLOOR_BAND[1] * rate)
            levels[row, column] = np.sqrt(np.median(density[inside]) * rate / 2.0)
    pooled = np.full(3, np.nan)
    for column in range(3):
        known = levels[np.isfinite(levels[:, column]), column]
        if known.size:
            pooled[column] = float(np.median(known))
    return pooled
