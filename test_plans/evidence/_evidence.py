"""Whether the channels of a segment were measured: one sentence for each that was not.

Values that repeat bit for bit although their own noise or a neighbour moves: no one measures there.

The last digits of a measured value change from sample to sample, unless its resolution is coarser than its
noise and nothing moves. Two things show that a live channel could not have stood still:

- *its own noise*: at some time before, at most a third of its samples repeated, and at least a third of its
  changes turned back. Noise then exceeds half a resolution step, every second sample changes wherever the
  value lies, and 20 equal samples have a chance below 1e-6, 50 of 1e-15. At a value of exactly zero this has
  to be so just before: an encoder that gives noise in motion gives none at standstill.
- *a witness*: the neighbour that moves it (the motor's torque for T_s, the wheel for the vehicle) has moved
  by a tenth of its own largest magnitude meanwhile. A shaft torque of exactly zero is left out: it may lie in
  the backlash.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from hil.core.recording import Recording
from hil.core.result import Segment
from hil.core.runtime.compiled import compiled
from test_plans.conductor import Array
from test_plans.evidence._dynamics import (
    INERTIA_IN_WORDS,
    LAG_IN_WORDS,
    inertia_in_words,
    lag_in_words,
)
from test_plans.evidence._relations import RELATIONS, contradictions, proven_channels

#: A channel with noise that repeats for longer than this is frozen, and one whose witness moves, s.
FROZEN_S, FROZEN_BESIDE_WITNESS_S = 0.05, 0.08
LEAST_SAMPLES = 20
_REPEATS, _TURNS = 1 / 3, 1 / 3
_MEMORY = 1 / 64  # of a sample in the shares of repeats and turns
_MOVED = 0.1  # of a witness's largest magnitude
_LEARNT_S = 1.0  # before a segment, in which its channels show their noise

#: Channels that a sensor gives, with the neighbour that moves each where there is one.
WITNESSES = {
    "motor_speed_rad_s": "",
    "wheel_speed_left_rad_s": "",
    "wheel_speed_right_rad_s": "",
    "wheel_speed_rad_s": "",
    "shaft_torque_left_nm": "motor_torque_ref_nm",
    "shaft_torque_right_nm": "motor_torque_ref_nm",
    "shaft_torque_nm": "motor_torque_ref_nm",
    "vehicle_speed_m_s": "wheel_speed_rad_s",
}
SENSORS = tuple(WITNESSES)
#: How far a witness has to move at least, in its unit: more than its noise.
_LEAST = {"motor_torque_ref_nm": 2.0, "wheel_speed_rad_s": 0.2, "wheel_speed_left_rad_s": 0.2}


class Repetition:
    """Follows the repetitions of some columns, sample by sample.

    Attributes:
        runs: how many samples each column has repeated by now, shape (columns,).
        noisy: whether each column's own noise was larger than its resolution before that, shape (columns,).
    """

    def __init__(self, columns: int) -> None:
        self.runs = np.zeros(columns, np.int64)
        self.noisy = np.zeros(columns, bool)
        #: Last value, last change, share of repeats, share of turns, whether noise was ever seen.
        self._state = np.tile(np.array([np.nan, 0.0, 1.0, 0.0, 0.0]), (columns, 1))

    @property
    def values(self) -> Array:
        """The newest value of each column."""
        return self._state[:, 0]

    def look(self, values: Array) -> None:
        """Take samples, shape (n, columns); what is not known (NaN) neither repeats nor ends a repetition."""
        _follow(np.ascontiguousarray(values), self._state, self.runs, self.noisy)


@dataclass(frozen=True)
class Frozen:
    """A channel that repeated, from when and for how long, in s of the recording, and what shows it."""

    channel: str
    start_s: float
    duration_s: float
    witness: str = ""

    def __str__(self) -> str:
        shown = (
            f"while {self.witness} moved"
            if self.witness
            else "though its noise is larger than its resolution"
        )
        return (
            f"{self.channel} repeats bit for bit for {self.duration_s * 1e3:.0f} ms at {self.start_s:.3f} s, "
            f"{shown}: it was not measured there (frozen, or at the end of its range)"
        )


def frozen_channels(recording: Recording, segment: Segment) -> dict[str, Frozen]:
    """Channels that were not measured somewhere in a segment, each with its longest repetition."""
    names = [name for name in SENSORS if name in recording]
    if not names or recording.samples < LEAST_SAMPLES:
        return {}
    first = recording.rows_before(max(segment.start_s - _LEARNT_S, recording.first_s))
    last = recording.rows_before(segment.end_s)
    beside = {WITNESSES[name] for name in names} & set(recording.channels)
    rows = recording.rows(first, last, ("time_s", *dict.fromkeys([*names, *beside])))
    found: dict[str, Frozen] = {}
    for name in names:
        known = np.isfinite(rows[name])
        time, values = rows["time_s"][known], rows[name][known]
        witness = rows.get(WITNESSES[name])
        for frozen in _stretches(name, time, values, None if witness is None else witness[known]):
            if frozen.start_s + frozen.duration_s > segment.start_s and (
                name not in found or frozen.duration_s > found[name].duration_s
            ):
                found[name] = frozen
    return found


def _stretches(name: str, time: Array, values: Array, witness: Array | None) -> Iterator[Frozen]:
    """Repetitions that are too long, in order."""
    if len(values) < LEAST_SAMPLES:
        return
    same = np.concatenate([[False], np.diff(values) == 0.0, [False]])
    edges = np.flatnonzero(np.diff(same.astype(np.int8)))
    follow = Repetition(1)
    seen = 0
    for start, end in zip(edges[::2], edges[1::2], strict=True):
        lasted_s = float(time[end] - time[start])
        if end - start < LEAST_SAMPLES or lasted_s < FROZEN_S:
            continue
        follow.look(values[seen : end + 1, np.newaxis])
        seen = end + 1
        if follow.noisy[0]:
            yield Frozen(name, float(time[start]), lasted_s)
            continue
        if witness is None or values[start] == 0.0:
            continue
        moved_s = _moved_for_s(WITNESSES[name], witness[: end + 1], time[: end + 1], int(start))
        if moved_s >= FROZEN_BESIDE_WITNESS_S:
            yield Frozen(name, float(time[start]), lasted_s, WITNESSES[name])


def _moved_for_s(witness: str, values: Array, time: Array, start: int) -> float:
    """For how long at the end a witness has been away from where it was at `start`."""
    known = np.isfinite(values)
    largest = float(np.max(np.abs(values), where=known, initial=0.0))
    part, stamps = values[start:][known[start:]], time[start:][known[start:]]
    if not part.size:
        return 0.0
    range_ = np.maximum.accumulate(part) - np.minimum.accumulate(part)
    first = int(np.searchsorted(range_, least_motion(witness, largest), "right"))
    return float(stamps[-1] - stamps[first]) if first < len(part) else 0.0


def least_motion(witness: str, largest: float) -> float:
    """What a witness has to move by: more than its noise, and a tenth of its largest magnitude so far."""
    return max(_LEAST[witness], _MOVED * largest)


@compiled
def _follow(values, state, runs, noisy):  # type: ignore[no-untyped-def]
    """Update the state of each column."""
    for column in range(values.shape[1]):
        last, change, repeats, turns, ever = state[column]
        for sample in range(values.shape[0]):
            value = values[sample, column]
            if np.isnan(value):
                continue
            step = value - last
            if step == 0.0:
                if runs[column] == 0:
                    now = repeats < _REPEATS and turns > _TURNS
                    noisy[column] = now or (ever > 0.0 and value != 0.0)
                runs[column] += 1
                repeats += _MEMORY * (1.0 - repeats)
            else:
                runs[column] = 0
                repeats -= _MEMORY * repeats
                turned = 1.0 if step * change < 0.0 else 0.0
                turns += _MEMORY * (turned - turns)
                if repeats < _REPEATS and turns > _TURNS:
                    ever = 1.0
                if not np.isnan(step):
                    change = step
            last = value
        state[column, 0], state[column, 1] = last, change
        state[column, 2], state[column, 3], state[column, 4] = repeats, turns, ever


#: Channels that are computed from both sides, and what they are computed from.
_SIDES = {
    "shaft_torque_nm": ("shaft_torque_left_nm", "shaft_torque_right_nm"),
    "wheel_speed_rad_s": ("wheel_speed_left_rad_s", "wheel_speed_right_rad_s"),
}


def _proofs() -> dict[str, tuple[str, ...]]:
    found: dict[str, list[str]] = {}
    for name in SENSORS:
        witness = f", or while {WITNESSES[name]} moves" if WITNESSES[name] else ""
        found.setdefault(name, []).append(f"does not repeat bit for bit beyond its noise{witness}")
    for one in RELATIONS:
        bounds = f"within {one.within[0]:g} to {one.within[1]:g} times"
        for name in one.channels:
            found.setdefault(name, []).append(f"{one.law}, {bounds}")
    for name in ("shaft_torque_nm", "motor_torque_nm"):
        found[name].append(LAG_IN_WORDS)
    for name in ("shaft_torque_nm", "wheel_speed_rad_s"):
        found[name].append(INERTIA_IN_WORDS)
    for whole, sides in _SIDES.items():
        found[whole] += [f"both sides: {text}" for text in dict.fromkeys(t for s in sides for t in found[s])]
    return {name: tuple(dict.fromkeys(texts)) for name, texts in found.items()}


#: What proves that a channel was measured, in words.
PROOFS = _proofs()


def objections(recording: Recording, segment: Segment) -> dict[str, str]:
    """Channels that were not measured in a segment, each with the reason; empty where all were.

    A relation in which two channels contradict each other counts against both: no one knows which of them
    is wrong.
    """
    found = {name: str(frozen) for name, frozen in frozen_channels(recording, segment).items()}
    found = {
        **inertia_in_words(recording, segment),
        **lag_in_words(recording, segment),
        **contradictions(recording, segment),
        **found,
    }
    for whole, sides in _SIDES.items():
        for side in sides:
            if side in found:
                found[whole] = found[side]
    return found


def unproven(recording: Recording, segment: Segment, channels: Iterable[str]) -> tuple[str, ...]:
    """Those of some channels that sensors give, and that nothing in a segment was held against."""
    proven = proven_channels(recording, segment)
    return tuple(name for name in channels if name in SENSORS and name in recording and name not in proven)
