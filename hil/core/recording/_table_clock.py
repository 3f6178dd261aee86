"""Times and rates of another tool's table: counters that begin again, rounded times, slower columns.

Also numbers that stand for no value.
"""

from __future__ import annotations

import itertools

import numpy as np

from hil.core.channels import CHANNELS, INPUT, TIME
from hil.core.errors import BadInputError
from hil.core.recording._checked import LARGEST_MISSING_SHARE
from hil.core.recording._column_map import OPTION
from hil.core.recording._table import Array

_REGULAR = 0.95  # of the distances of a slower column's values that are alike
_LEAST_VALUES = 4
#: What tools write where they have no value, if it is far from everything else in the column.
_SENTINELS = (
    *(sign * float(number) for sign in (-1, 1) for number in (9999, 99999, 999999, 9999999)),
    *(-32768.0, 32767.0, 65535.0, 4294967295.0, -2147483648.0, 2147483647.0),
    *(1e30, -1e30, 1e31, 9.9e37, 1e38, 3.4028234663852886e38, -3.4028234663852886e38),
)
_FAR = 5.0  # times the largest magnitude of all other values
_LARGEST_SHARE = 0.1
_LEAST_ROWS = 20


def of_one_rate(channels: dict[str, Array], notes: list[str]) -> dict[str, Array]:
    """The rows that have the input, with columns of other rates interpolated at their stamps.

    A column is of another rate if its values come at even distances of rows, with blanks between. Rows before
    the first and behind the last value of any of them are left out. Others stay as they are.
    """
    if TIME not in channels:
        return channels
    distances = {
        name: distance
        for name, values in channels.items()
        if name in CHANNELS and name != TIME and (distance := _distance(values))
    }
    if not distances:
        return channels
    time_s = channels[TIME]
    rows = np.isfinite(channels[INPUT]) if INPUT in distances else np.ones(len(time_s), bool)
    span = rows.copy()
    for name in distances:
        there = np.flatnonzero(np.isfinite(channels[name]))
        span[: there[0]] = False
        span[there[-1] + 1 :] = False
    chosen = np.flatnonzero(rows & span)
    found = {name: values[chosen] for name, values in channels.items()}
    for name, distance in distances.items():
        if name == INPUT:
            notes.append(f"'{name}' stands in each {_ordinal(distance)} row: the other rows were left out")
            continue
        there = np.isfinite(channels[name])
        if np.isfinite(found[name]).all():
            continue
        found[name] = np.interp(found[TIME], time_s[there], channels[name][there])
        notes.append(f"'{name}' stands in each {_ordinal(distance)} row: it was interpolated between")
    return found


def refuse_sentinel(values: Array, channel: str, where: str) -> None:
    """Refuse a number that tools write for no value, where it lies far from all others of its column.

    Args:
        values: as they stand in the file, before any conversion.

    Raises:
        BadInputError: there is one; names it and the option that decides it.
    """
    if len(values) < _LEAST_ROWS:
        return
    found = np.isin(values, _SENTINELS)
    count = int(np.count_nonzero(found))
    if not count or count > _LARGEST_SHARE * len(values):
        return
    others = values[~found & np.isfinite(values)]
    largest = float(np.abs(others).max()) if len(others) else 0.0
    number = float(values[found][0])
    if abs(number) > _FAR * largest:
        rows = "1 row" if count == 1 else f"{count} rows"
        raise BadInputError(
            f"is {number:g} in {rows}, and within ±{largest:.4g} in all others",
            where=where,
            fix=f"if that means that there is no value: {OPTION} '{channel}=COLUMN, missing={number:g}'; "
            "if it is one: missing= without a number",
        )


def _distance(values: Array) -> int:
    """Rows from value to value of a column of another rate; 0 of any other column."""
    there = np.flatnonzero(np.isfinite(values))
    if len(there) < _LEAST_VALUES or len(there) >= (1.0 - LARGEST_MISSING_SHARE) * len(values):
        return 0
    apart = np.diff(there)
    usual = int(np.median(apart))
    alike = float(np.mean(np.abs(apart - usual) <= 1)) if usual > 2 else float(np.mean(apart == usual))
    return usual if usual > 1 and alike >= _REGULAR else 0


def _ordinal(number: int) -> str:
    ending = "th" if number % 100 in (11, 12, 13) else {1: "st", 2: "nd", 3: "rd"}.get(number % 10, "th")
    return f"{number}{ending}"


_COUNTERS = (1 << 16, 1 << 32)
_MOST_STEPS = 20  # median steps that a counter may go on by where it begins again
_QUANTA_S = (1.0, 0.1, 0.01, 0.001)
_LEAST_SAMPLES, _LEAST_STRETCH, _WINDOW = 50, 20, 20
_BAND = 1.3  # of a quantum: residuals of stamps that are rounded, about a line fitted to them


def counted_on(stamps: Array, notes: list[str]) -> Array:
    """Stamps of a counter of 16 or 32 bits as one that goes on, in its own numbers; others as they are.

    A counter is known by whole numbers, none of them beyond its range, that go on where they begin again.
    """
    steps = np.diff(stamps)
    back = steps < 0
    if (
        not back.any()
        or not np.isfinite(stamps).all()
        or (stamps != np.rint(stamps)).any()
        or stamps.min() < 0
    ):
        return stamps
    forward = float(np.median(steps[~back])) if (~back).any() else 0.0
    for span in _COUNTERS:
        on = steps[back] + span
        if stamps.max() < span and (on > 0).all() and (on <= _MOST_STEPS * max(forward, 1.0)).all():
            count = int(np.count_nonzero(back))
            times = "once" if count == 1 else f"{count} times"
            notes.append(f"time counts in {span.bit_length() - 1} bits and begins again {times}: counted on")
            return np.asarray(stamps + span * np.concatenate([[0], np.cumsum(back)]))
    return stamps


def evenly_placed(time_s: Array, where: str, notes: list[str]) -> Array:
    """Stamps that are rounded to 1 s, 0.1 s, 10 ms or 1 ms, put where the samples' numbers place them.

    Within a stretch without a gap, samples that are evenly spaced have stamps about one line, no further from
    it than rounding takes them. Stamps of which that is not so stay as they are.

    Raises:
        BadInputError: many stamps stand several times, and the samples between are not evenly spaced.
    """
    quantum_s = _quantum_s(time_s)
    if not quantum_s:
        return time_s
    steps = np.rint(np.diff(time_s) / quantum_s)
    if (steps < 0).any() or (steps == steps[0]).all():
        return time_s
    window_s = time_s[_WINDOW:] - time_s[:-_WINDOW]
    apart_s = float(np.median(window_s)) / _WINDOW
    ends = np.flatnonzero(np.diff(time_s) > 3 * apart_s + 2 * quantum_s) + 1
    placed = _on_lines(time_s, [0, *ends.tolist(), len(time_s)], quantum_s)
    repeated = float(np.mean(steps == 0))
    if placed is None or (np.diff(placed) <= 0).any():
        if repeated > 0.01:
            raise BadInputError(
                f"{repeated:.0%} of the stamps in '{TIME}' repeat the one before: they are rounded to "
                f"{quantum_s:g} s, and samples are not evenly spaced",
                where=where,
                fix=f"export time with more digits, or give the distance of samples: {OPTION} "
                f"'{TIME}=, every_s={apart_s:.3g}'",
            )
        return time_s
    furthest_s = float(np.abs(placed - time_s).max())
    notes.append(
        f"stamps are rounded to {quantum_s * 1e3:g} ms: samples were placed {apart_s * 1e3:.4g} ms apart, "
        f"at most {furthest_s * 1e3:.3g} ms from their stamps"
    )
    return placed


def _quantum_s(time_s: Array) -> float:
    """The largest quantum of which all stamps are multiples; 0 if there is none or too few of them."""
    if len(time_s) < _LEAST_SAMPLES or not np.isfinite(time_s).all():
        return 0.0
    since_s = time_s - time_s[0]
    for quantum_s in _QUANTA_S:
        counts = since_s / quantum_s
        if np.all(np.abs(counts - np.rint(counts)) < 1e-4):
            return quantum_s
    return 0.0


def _on_lines(time_s: Array, ends: list[int], quantum_s: float) -> Array | None:
    """Each stretch on the line fitted to its stamps; None if a stretch is short or far from its line."""
    placed = np.empty(len(time_s))
    for begin, end in itertools.pairwise(ends):
        if end - begin < _LEAST_STRETCH:
            return None
        numbers = np.arange(end - begin, dtype=np.float64)
        numbers -= numbers.mean()
        own_s = time_s[begin:end]
        middle_s = float(own_s.mean())
        slope_s = float(numbers @ (own_s - middle_s)) / float(numbers @ numbers)
        line_s = middle_s + slope_s * numbers
        if np.ptp(own_s - line_s) > _BAND * quantum_s:
            return None
        placed[begin:end] = line_s
    return placed
