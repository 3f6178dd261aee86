"""One experiment: a stretch of a recording on even time stamps, and its Fourier lines.

Lines are scaled so that experiments of any length and rate can be put together.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy import fft

from hil.analysis.frequency_response._outside import split_by_motion
from hil.analysis.frequency_response._quality import UnfitDataError
from hil.analysis.plausible import refuse_implausible
from hil.core.channels import ANGLES, INPUT, TICK_S, TIME, read_from
from hil.core.errors import BadInputError
from hil.core.recording import Recording, run_of
from hil.core.result import Segment
from hil.plant import angle_at

Array = npt.NDArray[np.float64]

REFERENCE = "driving_torque_ref_nm"
EXCITING_KINDS = ("chirp", "multisine")
_JITTER_IGNORED = 0.02  # of a sample: what rounding to 1 µs does at 1 kHz is far below
_LARGEST_LOST_SHARE = 0.01


@dataclass(frozen=True)
class Experiment:
    """Input and outputs at even time steps.

    Attributes:
        name: file and segment, for messages.
        sample_time_s: time step.
        input: N samples of the input.
        outputs: O x N samples, in the order of `output_names`.
        reference: N samples of the loop's reference, where recorded.
        hold_s: how long the real input keeps a value (zero-order hold of the RMCU).
        kind: 'chirp', 'multisine', or '' where unknown.
        input_name: the channel that `input` was recorded as.
    """

    name: str
    sample_time_s: float
    input: Array
    outputs: Array
    output_names: tuple[str, ...]
    reference: Array | None = None
    hold_s: float = 0.0
    kind: str = ""
    notes: tuple[str, ...] = ()
    input_name: str = INPUT

    @property
    def duration_s(self) -> float:
        """Length in seconds."""
        return len(self.input) * self.sample_time_s


def segments_of(recording: Recording) -> tuple[Segment, ...]:
    """Segments of the run that made the recording; none for data of another tool."""
    run = run_of(recording)
    return () if run is None else run.segments


def experiments_of(
    recording: Recording,
    *,
    segments: Sequence[str] = (),
    input_channel: str = INPUT,
    to_hz: float = 30.0,
    hold_s: float | None = None,
) -> list[Experiment]:
    """Cut a recording into experiments.

    Without `segments`, each chirp or multisine segment of the run is one experiment. A recording without
    segments is one experiment, or several where stretches are left out in which the input rests and something
    else moves the axle.

    Args:
        recording: the data.
        segments: ids of the run's segments to use instead.
        input_channel: the channel that excites.
        to_hz: highest frequency of interest; decides whether gaps in time matter.
        hold_s: how long the input keeps a value; default: the sample time, at most the RMCU's 1 ms.

    Raises:
        BadInputError: an unknown segment, no exciting segment, a missing channel, values that no axle gives.
        UnfitDataError: time stamps too uneven to resample.
    """
    refuse_implausible(recording)
    known = segments_of(recording)
    chosen = _choose(known, segments, str(recording.source))
    if not chosen:
        return _without_segments(recording, input_channel, to_hz, hold_s)
    return [
        _experiment(
            recording.between(part.start_s, part.end_s),
            f"{recording.source}: segment {part.id}",
            part.kind,
            input_channel,
            to_hz,
            hold_s,
        )
        for part in chosen
    ]


def _without_segments(
    recording: Recording, input_channel: str, to_hz: float, hold_s: float | None
) -> list[Experiment]:
    name = str(recording.source)
    kept, left_out = split_by_motion(recording, input_channel)
    if not kept:
        return [_experiment(recording, name, "", input_channel, to_hz, hold_s)]
    words = ", ".join(one.in_words for one in left_out)
    note = f"left out: {words}; the input rests, and something else moves the axle in one of them"
    found = [
        _experiment(
            recording.between(one.start_s, one.end_s),
            f"{name}: {one.in_words}",
            "",
            input_channel,
            to_hz,
            hold_s,
        )
        for one in kept
    ]
    return [replace(found[0], notes=(*found[0].notes, note)), *found[1:]]


def _choose(known: Sequence[Segment], wanted: Sequence[str], where: str) -> list[Segment]:
    for name in wanted:
        if name not in {part.id for part in known}:
            ids = ", ".join(part.id for part in known) or "none"
            raise BadInputError(f"has no segment '{name}'", where=where, fix=f"its segments: {ids}")
    if wanted:
        return [part for part in known if part.id in wanted]
    exciting = [part for part in known if part.kind in EXCITING_KINDS]
    if known and not exciting:
        raise BadInputError(
            "none of its segments is a chirp or a multisine",
            where=where,
            fix=f"choose with --segment, or run an identification plan; segments: "
            f"{', '.join(part.id for part in known)}",
        )
    return exciting


def _experiment(
    recording: Recording, name: str, kind: str, input_channel: str, to_hz: float, hold_s: float | None
) -> Experiment:
    sources = read_from(recording)
    outputs = tuple(sources)
    names = [input_channel, *sources.values()]
    if REFERENCE in recording and np.all(np.isfinite(recording[REFERENCE])):
        names.append(REFERENCE)
    raw = np.array([_readings(recording, channel) for channel in names])
    if raw.shape[1] < 2:
        raise UnfitDataError("too_short", f"has {raw.shape[1]} samples", where=name)
    values, step, notes = _even(recording[TIME], raw, to_hz, name)
    for row, (output, channel) in enumerate(sources.items(), start=1):
        if channel != output:
            values[row] = _slope(values[row], step)
            notes = (*notes, f"{output} is the slope of {channel}")
    return Experiment(
        name,
        step,
        values[0],
        values[1 : 1 + len(outputs)],
        outputs,
        values[-1] if REFERENCE in names else None,
        min(step, TICK_S) if hold_s is None else hold_s,
        kind,
        tuple(recording.notes) + notes,
        input_channel,
    )


def _readings(recording: Recording, channel: str) -> Array:
    """Of a channel; an angle that begins again with every turn goes on."""
    if channel in ANGLES.values():
        return angle_at(recording, channel, recording.time_s)
    return recording[channel]


def _slope(values: Array, step: float) -> Array:
    """Of a cubic spline through values: right to 0.2 % up to an eighth of the rate."""
    from scipy.interpolate import CubicSpline  # slow to import

    time = step * np.arange(len(values))
    return np.asarray(CubicSpline(time, values).derivative()(time))


def _even(time: Array, values: Array, to_hz: float, where: str) -> tuple[Array, float, tuple[str, ...]]:
    """Values on even time stamps, the step, and a note if they had to be resampled."""
    steps = np.diff(time)
    step = float(np.median(steps))
    mean = float(time[-1] - time[0]) / (len(time) - 1)
    ideal = time[0] + mean * np.arange(len(time))
    if np.max(np.abs(time - ideal)) <= _JITTER_IGNORED * mean:
        return values, mean, ()
    lost = float(np.sum(steps[steps > 1 / (4 * to_hz)])) / float(time[-1] - time[0])
    if lost > _LARGEST_LOST_SHARE:
        raise UnfitDataError(
            "uneven_time",
            f"{lost:.1%} of the time lies in gaps longer than {250 / to_hz:.3g} ms (a quarter period at "
            f"{to_hz:g} Hz; longest {np.max(steps):.3g} s near {time[int(np.argmax(steps))]:.6g} s), "
            f"{_LARGEST_LOST_SHARE:.0%} is allowed",
            where=where,
            fix="record without gaps, or lower --to-hz",
        )
    grid = np.arange(time[0], time[-1] + 0.5 * step, step)
    grid = grid[grid <= time[-1]]
    note = (
        f"time stamps are uneven (steps of {np.min(steps) * 1e3:.3g} to {np.max(steps) * 1e3:.3g} ms): "
        f"resampled to {step * 1e3:.4g} ms with a cubic spline"
    )
    from scipy.interpolate import CubicSpline  # slow to import

    return CubicSpline(time, values, axis=1)(grid), step, (note,)


ComplexArray = npt.NDArray[np.complex128]


@dataclass(frozen=True)
class Lines:
    """Fourier lines of one experiment between two frequencies.

    `input`, `reference` (L) and `output_rate` (O x L) are Fourier transforms divided by the square root
    of the duration, so that their squared magnitude is a two-sided power spectral density.
    `output_rate` is the output times jω: what is fitted is jω·G, then divided by jω again.
    """

    frequency_hz: Array
    input: ComplexArray
    output_rate: ComplexArray
    reference: ComplexArray | None


def fourier_lines(experiment: Experiment, from_hz: float, to_hz: float) -> Lines:
    """Lines from `from_hz` to `to_hz` (ends included, zero frequency never).

    Outputs are differenced before the transform and the difference is divided out exactly: an axle
    integrates torque to speed, and without this the speed gained over the record would leak over all
    low frequencies. The input is delayed by half its hold time, which is what a zero-order hold does
    well below the sampling rate; so the hold is not counted as dead time of the plant.
    """
    step = experiment.sample_time_s
    count = int(fft.prev_fast_len(len(experiment.input) - 1, real=True))
    frequency = np.arange(count // 2 + 1) / (count * step)
    wanted = (frequency >= from_hz) & (frequency <= to_hz) & (frequency > 0)
    frequency = frequency[wanted]
    scale = step / np.sqrt(count * step)
    s = 2j * np.pi * frequency

    def lines(values: Array) -> ComplexArray:
        return np.asarray(fft.rfft(values, axis=-1)[..., wanted] * scale)

    difference = np.diff(experiment.outputs, axis=1)[:, :count]
    first = slice(1, count + 1)
    return Lines(
        frequency,
        lines(experiment.input[first]) * np.exp(-0.5 * experiment.hold_s * s),
        lines(difference) * (s / -np.expm1(-s * step)),
        None if experiment.reference is None else lines(experiment.reference[first]),
    )
