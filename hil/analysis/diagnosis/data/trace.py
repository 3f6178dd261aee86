"""A recording made ready for fits: even samples, block means, noise level, a first guess of its start."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data.thresholds import (
    FIRST_STAMPS,
    FIT_RATE_HZ,
    GAP_SAMPLES,
    LEAST_DURATION_S,
    LEAST_SAMPLES,
    LITTLE_TORQUE,
    NEAR_SHARE,
    SLOWEST_SAMPLE_S,
    START_SAMPLES,
    UNEVEN_SHARE,
)
from hil.analysis.spikes import without_spikes
from hil.core.channels import ANGLES, CHANNELS, INPUT, OUTPUTS, WHEEL_ANGLE, read_from
from hil.core.errors import BadInputError
from hil.core.errors.wording import closest
from hil.core.recording import Recording
from hil.plant import SENSOR_GAIN, SENSOR_OFFSET, TURNED_OVER_S, angle_at, by_angle, speed_of, turned

Array = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class Trace:
    """One recording on an even grid.

    `measured` is blocks x 3 in the order of `OUTPUTS` (NaN where a channel is missing), each the mean of
    `block` samples; `samples` is the same at full rate; `start` is motor speed, wheel speed (rad/s) and
    shaft torque (N m) at first, means of `start_samples`, NaN where not measured. `source` is the file, for
    messages. `load` is the torque in N m that brakes the wheels at every sample; None where the model takes
    none. `of_angle` (3,) are speeds read from an angle.
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
    source: str = ""
    load: Array | None = None
    start_samples: int = START_SAMPLES
    of_angle: Flags = field(default_factory=lambda: np.zeros(3, dtype=bool))

    def angles(self, gear_ratio: float, sensors: Array | None = None) -> Array:
        """Wheel and rotor angle in rad at every sample, n x 2, integrated from the measured speeds.

        Where no speed was measured they stay at zero: no order can be seen. Gain and offset of `sensors`
        (as of `ideal_sensors`) are taken out.
        """
        speeds = self.samples[:, :2]
        if sensors is not None:
            speeds = (speeds - sensors[:2, SENSOR_OFFSET]) / sensors[:2, SENSOR_GAIN]
        return turned(speeds, self.dt, gear_ratio, self.first_wheel_angle_rad)

    @property
    def has(self) -> Flags:
        """Which of the three channels were measured."""
        return np.asarray(np.isfinite(self.measured[0]))


def trace_of(recording: Recording, name: str = "", load: Array | None = None) -> Trace:
    """Put readings on even times, each as it is; interpolate only where none is near; average to blocks.

    Args:
        load: torque in N m that brakes the wheels, at the recording's time stamps.

    Raises:
        BadInputError: too few samples, too short, or sampled too slowly to see a driveline.
    """
    where = str(recording.source)
    time, dt = recording.time_s, recording.sample_time_s
    if len(time) < LEAST_SAMPLES:
        raise BadInputError(f"has {len(time)} samples, a diagnosis needs {LEAST_SAMPLES}", where=where)
    if dt > SLOWEST_SAMPLE_S:
        raise BadInputError(
            f"is sampled every {dt * 1e3:g} ms: too slow for a driveline",
            where=where,
            fix="record at 100 Hz or more, best at 1 kHz; or is time_s in another unit?",
        )
    lasts = float(time[-1] - time[0])
    if lasts < LEAST_DURATION_S:
        raise BadInputError(
            f"lasts {lasts:.3g} s, a diagnosis needs {LEAST_DURATION_S:g} s",
            where=where,
            fix="record longer; or is time_s in another unit?",
        )
    notes = [*recording.notes, *_not_used(recording)]
    grid, dt = _even(time, dt)
    nearest = _nearest(time, grid)
    off = np.abs(time[nearest] - grid)
    if off.max() > UNEVEN_SHARE * dt:
        note = f"time stamps are uneven: put on a grid of {dt * 1e3:.4g} ms"
        if (gap := np.diff(time)).max() > GAP_SAMPLES * dt:
            note += f", with a gap of {gap.max():.3g} s at {time[int(np.argmax(gap))]:.3g} s bridged"
        notes.append(note)
    missing = off > NEAR_SHARE * dt
    given = [c for c in OUTPUTS if c in recording]
    columns = [recording[INPUT], *(recording[c] for c in given)]
    on_grid = [np.where(missing, np.interp(grid, time, values), values[nearest]) for values in columns]
    for index, channel in enumerate(given, start=1):
        on_grid[index], note = without_spikes(on_grid[index], channel, dt)
        notes += [note] if note else []
    torque = np.ascontiguousarray(on_grid[0])
    samples = np.full((len(grid), 3), np.nan)
    for channel, values in zip(given, on_grid[1:], strict=True):
        samples[:, OUTPUTS.index(channel)] = values
    for column in np.flatnonzero(by_angle(recording)).tolist():
        angle = ANGLES[OUTPUTS[column]]
        samples[:, column] = speed_of(angle_at(recording, angle, grid), dt)
        notes.append(f"{OUTPUTS[column]} is what {angle} turns by within {TURNED_OVER_S * 1e3:g} ms")
    block = max(1, round(1.0 / (FIT_RATE_HZ * dt)))
    first = _before_torque(torque)
    return Trace(
        name or recording.source.stem,
        torque,
        dt,
        block,
        samples,
        blocks(samples, block),
        samples[:first].mean(axis=0),
        tuple(notes),
        float(recording[WHEEL_ANGLE][0]) if WHEEL_ANGLE in recording else 0.0,
        where,
        load=None if load is None else np.where(missing, np.interp(grid, time, load), load[nearest]),
        start_samples=first,
        of_angle=by_angle(recording),
    )


def _not_used(recording: Recording) -> list[str]:
    """What to say of channels whose names are nearly those that a diagnosis looks for."""
    strange = [name for name in recording.channels if name not in CHANNELS]
    there = read_from(recording)
    return [
        f"has no {channel}, and '{near}' is not used: if it is that, rename it"
        for channel in OUTPUTS
        if channel not in there and (near := closest(channel, strange))
    ]


def _even(time: Array, dt: float) -> tuple[Array, float]:
    """Even times from the first to the last of `time`, about `dt` apart, and their exact distance.

    The distance is a straight line through the stamps, over ever more of them: jitter and missing stamps
    must not make the count of samples slip.
    """
    steps = np.diff(time)
    near = steps[np.abs(steps - dt) < 0.5 * dt]
    dt = float(np.mean(near)) if len(near) else dt
    seen = FIRST_STAMPS
    while seen < 4 * len(time):
        passed = time[:seen] - time[0]
        number = np.rint(passed / dt)
        dt = float(np.polynomial.polynomial.polyfit(number, passed, 1)[1])
        seen *= 4
    count = max(1, round((time[-1] - time[0]) / dt))
    return np.linspace(time[0], time[-1], count + 1), float(time[-1] - time[0]) / count


def _nearest(time: Array, grid: Array) -> npt.NDArray[np.intp]:
    """Index of the time stamp that lies nearest to each point of the grid."""
    after = np.clip(np.searchsorted(time, grid), 1, len(time) - 1)
    return np.asarray(after - (grid - time[after - 1] < time[after] - grid))


def blocks(samples: Array, block: int) -> Array:
    """Means of `block` rows each; what does not fill a block is left out."""
    count = len(samples) // block
    return np.asarray(samples[: count * block].reshape(count, block, -1).mean(axis=1))


def _before_torque(torque: Array) -> int:
    """How many samples there are before the torque does anything: a fed back torque is never quite zero."""
    least = LITTLE_TORQUE * float(np.max(np.abs(torque)))
    changed = np.flatnonzero(np.abs(torque[:START_SAMPLES] - torque[0]) > least)
    return max(3, int(changed[0]) if changed.size else min(START_SAMPLES, len(torque)))
