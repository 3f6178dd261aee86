"""The stretches of a recording that can be explained at all: without gaps, and not too long to read."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.core.channels import ANY_OUTPUT, INPUT, TIME
from hil.core.errors import BadInputError
from hil.core.recording import Recording

Array = npt.NDArray[np.float64]

LEAST_SAMPLES = 200
"""A stretch with fewer is left out, or refused where it is all there is."""
LEAST_DURATION_S = 0.15
"""The same of a shorter one: fewer than some tens of block means say nothing."""
MOST_SAMPLES = 400_000
"""Of a longer stretch excerpts are read: memory and time are bounded."""
EXCERPTS = 10
GAP_SAMPLES = 20.0
"""A longer pause is a gap."""


def unbroken(recording: Recording, load: str = "") -> list[Recording]:
    """The stretches of a recording between its gaps: no one knows what happened in a gap.

    Stretches too short for a diagnosis are left out; the first one's notes say what was cut.

    Args:
        load: the channel whose torque brakes the wheels, where the model takes one.

    Raises:
        BadInputError: no stretch is long enough.
    """
    if recording.samples < 2:
        return [recording]
    gaps = _gaps(recording, {INPUT, *ANY_OUTPUT, load})
    if not gaps:
        return [recording]
    behind = np.maximum.accumulate([gap.after for gap in gaps]).tolist()
    pieces = [
        _piece(recording, first, last)
        for first, last in zip([0, *behind], [*(gap.begins for gap in gaps), recording.samples], strict=True)
        if last - first >= LEAST_SAMPLES
        and recording.time_at(last - 1) - recording.time_at(first) >= LEAST_DURATION_S
    ]
    if not pieces:
        raise BadInputError(
            f"has {len(gaps)} gaps, and no {LEAST_SAMPLES} samples without one between them",
            where=str(recording.source),
            fix="record again without gaps",
        )
    left_out = len(gaps) + 1 - len(pieces)
    longest = max(gaps, key=lambda gap: gap.lasts_s)
    note = f"cut at gaps: {len(gaps)}, the longest of {longest.lasts_s:.3g} s at {longest.start_s:.4g} s"
    pieces[0].notes.append(note + (f"; short stretches left out: {left_out}" if left_out else ""))
    return pieces


def runs(flags: npt.NDArray[np.bool_]) -> npt.NDArray[np.intp]:
    """Where runs of true begin, and where they have ended: runs x 2."""
    return np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]))).reshape(-1, 2)


def without(recording: Recording, left_out: npt.NDArray[np.bool_], least_s: float) -> list[Recording]:
    """The stretches between runs of samples that are left out, of those that last so long at least.

    The whole where none is long enough.
    """
    dt = recording.sample_time_s
    kept: list[list[int]] = []
    for first, last in runs(~left_out).tolist():
        if kept and (first - kept[-1][1]) * dt < least_s:
            kept[-1][1] = last
        else:
            kept.append([first, last])
    long = [(a, b) for a, b in kept if b - a >= LEAST_SAMPLES and (b - a) * dt >= LEAST_DURATION_S]
    if not long or long == [(0, recording.samples)]:
        return [recording]
    return [_piece(recording, first, last) for first, last in long]


@dataclass(frozen=True)
class _Gap:
    """A pause between two samples, or samples that lack a channel: `begins` to `after` are left out."""

    start_s: float
    lasts_s: float
    begins: int
    after: int


def _gaps(recording: Recording, counting: set[str]) -> list[_Gap]:
    gaps = [*_pauses(recording), *_holes(recording, counting)]
    return sorted(gaps, key=lambda gap: (gap.begins, gap.after))


def _holes(recording: Recording, counting: set[str]) -> list[_Gap]:
    """Where a channel that counts was interpolated for longer than a straight line can stand for it."""
    missing = np.zeros(recording.samples, bool)
    for channel in recording.mended.keys() & counting:
        at = recording.mended[channel]
        for run in np.split(at, np.flatnonzero(np.diff(at) > 1) + 1):
            if len(run) > GAP_SAMPLES:
                missing[run] = True
    dt = recording.sample_time_s
    found = runs(missing).tolist()
    return [_Gap(recording.time_at(begins), (after - begins) * dt, begins, after) for begins, after in found]


def _pauses(recording: Recording) -> list[_Gap]:
    gaps = []
    last_s = np.zeros(0)
    for first, rows in recording.blocks((TIME,)):
        time = np.concatenate([last_s, rows[TIME]])
        steps = np.diff(time)
        for at in np.flatnonzero(steps > GAP_SAMPLES * recording.sample_time_s).tolist():
            after = first - len(last_s) + at + 1
            gaps.append(_Gap(float(time[at]), float(steps[at]), after, after))
        last_s = time[-1:]
    return gaps


def excerpts(recording: Recording) -> list[Recording]:
    """The recording, or where it is very long ten stretches spread evenly over it; the first's notes say so.

    Ten stretches rather than every tenth sample: what torque does between samples must be known.
    """
    count = recording.samples
    if count <= MOST_SAMPLES:
        return [recording]
    size = MOST_SAMPLES // EXCERPTS
    firsts = np.linspace(0, count - size, EXCERPTS).round().astype(int).tolist()
    pieces = [_piece(recording, first, first + size) for first in firsts]
    seconds = size * recording.sample_time_s
    pieces[0].notes.append(
        f"has {count} samples: {EXCERPTS} stretches of {seconds:.4g} s, spread evenly over its "
        f"{recording.last_s - recording.first_s:.5g} s, stand for it"
    )
    return pieces


def _piece(recording: Recording, first: int, last: int) -> Recording:
    """Samples `first` to `last` as a recording that is named after the time it begins at."""
    began = f" from {recording.time_at(first):.4g} s" if first else ""
    source = recording.source.with_name(f"{recording.source.stem}{began}{recording.source.suffix}")
    notes = list(recording.notes) if first == 0 else []
    return dataclasses.replace(recording.piece(first, last), source=source, notes=notes)
