"""Stretches of a recording in which something else than the input moves the axle: a dyno, a brake, a slope.

A recording of another tool has no segments, and may hold the way to the test speed and back. That can be seen
where the input rests: there the speed changes faster than the input makes it change. If it does in one rest,
none is used: a bench that takes over between two tests mostly holds the speed, which looks like nothing.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.core.channels import OUTPUTS, TIME
from hil.core.recording import Recording

Array = npt.NDArray[np.float64]

_LEAST_REST_S = 0.5
_WINDOW_S = 1.0  # slower than the torsion of a driveline
_LEAST_KEPT_S = 2.0
_FASTER = 2.0  # than under the input: a coast of the axle alone is slower
_LEAST_EXCITED = 0.5  # share of the recording: a sequence of steps rests nearly always, and is one experiment


@dataclass(frozen=True)
class Stretch:
    """From `start_s` to `end_s` of the recording's time."""

    start_s: float
    end_s: float

    @property
    def in_words(self) -> str:
        """For messages."""
        return f"{self.start_s:.4g} to {self.end_s:.4g} s"


def split_by_motion(recording: Recording, input_channel: str) -> tuple[list[Stretch], list[Stretch]]:
    """Stretches to use, and rests of the input, in which something else moves the axle.

    Both are empty where the whole recording is to be used.
    """
    speeds = [name for name in OUTPUTS[:2] if name in recording]
    if not speeds or input_channel not in recording:
        return [], []
    time, torque, speed = recording[TIME], recording[input_channel], recording[speeds[0]]
    if not (np.all(np.isfinite(torque)) and np.all(np.isfinite(speed))):
        return [], []
    rests = _rests(time, torque)
    length_s = float(time[-1] - time[0])
    if not rests or length_s - sum(one.end_s - one.start_s for one in rests) < _LEAST_EXCITED * length_s:
        return [], []
    moments, change, mean = _changes(time, speed, torque)
    half_s = 0.5 * _WINDOW_S
    free = np.ones(len(moments), bool)
    for rest in rests:
        free &= (moments + half_s < rest.start_s) | (moments - half_s > rest.end_s)
    if not free.any():
        return [], []
    # a constant torque may be larger than any mean of one that varies
    largest = max(float(np.max(np.abs(mean[free]))), 1e-300)
    allowed = _FASTER * float(np.max(np.abs(change[free]))) * np.maximum(1.0, np.abs(mean) / largest)
    resting = np.zeros(len(moments), bool)
    for rest in rests:
        resting |= (moments >= rest.start_s) & (moments <= rest.end_s)
    if not np.any(np.abs(change[resting]) > allowed[resting]):
        return [], []
    kept = _between(rests, float(time[0]), float(time[-1]))
    return (kept, rests) if kept else ([], [])


def _rests(time: Array, torque: Array) -> list[Stretch]:
    """Where the input keeps a value, bit for bit, for a while."""
    changes = np.flatnonzero(np.diff(torque) != 0)
    edges = np.concatenate([[-1], changes, [len(torque) - 1]])
    return [
        Stretch(float(time[first + 1]), float(time[last]))
        for first, last in itertools.pairwise(edges)
        if time[last] - time[first + 1] >= _LEAST_REST_S
    ]


def _changes(time: Array, speed: Array, torque: Array) -> tuple[Array, Array, Array]:
    """Moments, how fast the speed changes there, and the mean torque, by a Hann window that slides along."""
    step_s = float(np.median(np.diff(time)))
    length = max(8, round(_WINDOW_S / step_s))
    hop = max(1, length // 10)
    if len(time) < length:
        return np.zeros(0), np.zeros(0), np.zeros(0)
    phase = 2.0 * np.pi * (np.arange(length) + 0.5) / length
    window = (1.0 - np.cos(phase)) / length
    slope = -2.0 * np.pi * np.sin(phase) / (length * length * step_s)
    changes, means = (
        np.asarray(np.lib.stride_tricks.sliding_window_view(row, length)[::hop] @ weights)
        for row, weights in ((speed, slope), (torque, window))
    )
    return np.asarray(time[: len(time) - length + 1 : hop] + 0.5 * length * step_s), changes, means


def _between(left_out: list[Stretch], first_s: float, last_s: float) -> list[Stretch]:
    edges = [first_s, *(edge for one in left_out for edge in (one.start_s, one.end_s)), last_s]
    between = [Stretch(start, end) for start, end in zip(edges[::2], edges[1::2], strict=True)]
    return [one for one in between if one.end_s - one.start_s >= _LEAST_KEPT_S]
