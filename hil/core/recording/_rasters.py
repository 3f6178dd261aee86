"""Tables of several rates, whose slower columns have blanks between; and numbers that stand for no value."""

from __future__ import annotations

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
