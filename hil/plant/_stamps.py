"""Uneven time stamps: whose time readings keep, even times over them, and inputs that are held between them.

A logger stamps what a device sends when it comes in: then stamps jitter and readings do not. Or a loop
reads when it comes to it, and the stamp is right. The readings tell which: one that was taken when its stamp
says is off the mean of its neighbours by its slope times how far the stamp is off theirs.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from hil.core.channels import ANGLES, OUTPUTS, TIME
from hil.core.recording import Recording

Array = npt.NDArray[np.float64]

UNEVEN_SHARE = 0.01
"""Of a step, by which stamps may be off and still be even."""
_LOST = 0.5  # of a usual step may others be longer or shorter: where more, samples were lost
_AROUND = 10  # samples on each side, over which a slope is taken: that of two neighbours is noise
_HALF = 0.5


def at_true_times(recording: Recording) -> Recording:
    """A recording, its stamps those of the clock that they jitter around where its readings keep that."""
    times = _times(recording)
    if times is recording.time_s:
        return recording
    return replace(recording, channels={**recording.channels, TIME: times})


def jittered(dt: float) -> str:
    """Note on a recording whose stamps were replaced, where a clock's times are `dt` seconds apart."""
    return f"time stamps jitter and readings keep a clock: taken to be {dt * 1e3:.4g} ms apart"


def _times(recording: Recording) -> Array:
    """Time stamps in s, or the times of a clock, (n,); each stamp must be nearest to a time of its own."""
    time = recording.time_s
    steps = np.diff(time)
    usual = float(np.mean(steps)) if len(steps) else 0.0
    if len(time) < 4 * _AROUND or np.max(np.abs(steps - usual)) <= UNEVEN_SHARE * usual:
        return time
    grid, dt = even_times(time)
    place = np.rint((time - grid[0]) / dt).astype(np.int64)
    off = time - grid[np.clip(place, 0, len(grid) - 1)]
    if np.max(np.abs(off)) <= UNEVEN_SHARE * dt or np.any(np.diff(place) < 1):
        return time
    names = [name for name in (*OUTPUTS, *ANGLES.values()) if name in recording]
    return time if _by_stamps(place, off, dt, [recording[name] for name in names]) else grid[place]


def _by_stamps(place: npt.NDArray[np.int64], off: Array, dt: float, channels: list[Array]) -> bool:
    """Whether readings were taken when their stamps say; these are `off` the times of a clock."""
    inner = slice(_AROUND, -_AROUND)
    whole = (place[2 * _AROUND :] - place[: -2 * _AROUND]) == 2 * _AROUND
    bend = _off_neighbours(off)[inner][whole]
    both = square = 0.0
    for values in channels:
        away = _off_neighbours(values)[inner][whole]
        slope = (values[2 * _AROUND :] - values[: -2 * _AROUND])[whole] / (2 * _AROUND * dt)
        variance = max(float(np.mean(away**2)), 1e-300) if len(away) else 1.0
        both += float((slope * bend) @ away) / variance
        square += float((slope * bend) @ (slope * bend)) / variance
    return both >= _HALF * square


def _off_neighbours(values: Array) -> Array:
    """Each value less the mean of the two beside it; zero at both ends."""
    found = np.zeros(len(values))
    found[1:-1] = values[1:-1] - 0.5 * (values[:-2] + values[2:])
    return found


def even_times(time: Array) -> tuple[Array, float]:
    """Even times over uneven stamps and their distance, in s: those of a clock where stamps jitter so.

    Samples that were lost have their times as well.
    """
    steps = np.diff(time)
    usual = float(np.mean(steps[np.abs(steps / np.median(steps) - 1.0) < _LOST]))
    # a stamp that is late makes one step longer and the next one shorter: their sum is right
    place = np.concatenate([[0.0], np.cumsum(np.rint(steps / usual))])
    dt, first = np.polyfit(place, time, 1)
    if np.max(np.abs(first + dt * place - time)) > _HALF * dt:  # no clock: steps of several lengths
        place, first = np.array([round((time[-1] - time[0]) / usual)], dtype=float), float(time[0])
        dt = (time[-1] - first) / place[-1]
    return np.asarray(first + dt * np.arange(round(place[-1]) + 1)), float(dt)


def held_over(grid: Array, dt: float, time: Array, torque: Array) -> Array:
    """Mean over each step of a grid of a torque that is held from stamp to stamp: its impulse is kept.

    Where samples were lost it goes straight from the one before to the one after.
    """
    lost = grid[
        np.append(np.diff(time), 0.0)[np.clip(np.searchsorted(time, grid, side="right") - 1, 0, None)]
        > (1.0 + _LOST) * dt
    ]
    begins = np.union1d(time, lost)
    ends = np.append(begins, time[-1] + dt)
    impulse = np.concatenate([[0.0], np.cumsum(np.interp(begins, time, torque) * np.diff(ends))])
    between = np.append(grid, grid[-1] + dt)
    return np.asarray(np.diff(np.interp(between, ends, impulse)) / dt)
