"""Data that no axle gives, whatever its parameters: refused before any computing, by name and place."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import numpy.typing as npt

from hil.core.channels import ANY_OUTPUT, INPUT, MOTOR_ANGLE, TIME, WHEEL_ANGLE
from hil.core.errors import BadInputError
from hil.core.recording import Recording

Array = npt.NDArray[np.float64]

#: In the channel's SI unit: hundreds of thousands of times what an axle can.
LARGEST_VALUE = 1e9
#: Without a gear and without compliance these two are one and the same.
_SAME_IF_DIRECT = [{"motor_speed_rad_s", "wheel_speed_rad_s"}, {MOTOR_ANGLE, WHEEL_ANGLE}]


def refuse_implausible(recording: Recording) -> None:
    """Refuse values that no axle gives, and channels that are copies of each other.

    Raises:
        BadInputError: time does not increase, a value is not finite or beyond 1e9 in SI units, or two
            channels that move are equal at every sample; names channels, and time or file.
    """
    names = [name for name in (INPUT, *ANY_OUTPUT) if name in recording]
    where = str(recording.source)
    seen = {name: _Seen() for name in names}
    alike = [pair for pair in combinations(names, 2) if set(pair) not in _SAME_IF_DIRECT]
    last_s = np.zeros(0)
    for first, rows in recording.blocks((TIME, *names)):
        _refuse_backwards(np.concatenate([last_s, rows[TIME]]), first - len(last_s), where)
        last_s = rows[TIME][-1:]
        for name, one in seen.items():
            one.look(rows[name], rows[TIME])
        alike = [(one, other) for one, other in alike if np.array_equal(rows[one], rows[other])]
    for name, one in seen.items():
        if one.impossible:
            raise BadInputError(
                f"'{name}' is {one.first:g} at {one.first_s:.6g} s: no axle does that "
                f"({one.impossible} such values, {LARGEST_VALUE:g} is allowed)",
                where=where,
                fix="correct or omit these samples",
            )
    for name, other in alike:
        if seen[name].highest > seen[name].lowest:
            raise BadInputError(
                f"'{name}' and '{other}' are equal at every sample: one is a copy of the other",
                where=where,
                fix="give each channel its own signal, or leave the copy out",
            )


@dataclass
class _Seen:
    """A channel's range, and how many of its values are impossible, with the first one and its time in s."""

    lowest: float = np.inf
    highest: float = -np.inf
    impossible: int = 0
    first: float = np.nan
    first_s: float = np.nan

    def look(self, values: Array, time: Array) -> None:
        impossible = ~(np.abs(values) <= LARGEST_VALUE)
        if not self.impossible and impossible.any():
            row = int(np.argmax(impossible))
            self.first, self.first_s = float(values[row]), float(time[row])
        self.impossible += int(np.count_nonzero(impossible))
        self.lowest = min(self.lowest, float(np.min(values)))
        self.highest = max(self.highest, float(np.max(values)))


def _refuse_backwards(time: Array, first: int, where: str) -> None:
    """`first`: number of the first of these time stamps."""
    backwards = ~(np.diff(time) > 0)
    if backwards.any():
        row = int(np.argmax(backwards)) + 1
        raise BadInputError(
            f"'{TIME}' does not increase at sample {first + row + 1} ({time[row]:.17g} s)",
            where=where,
            fix="let time_s start near zero: far from it floating point cannot tell the samples apart",
        )


def same_data(one: Recording, other: Recording) -> bool:
    """Whether two recordings hold the same measurement: equal input and outputs, whatever the file.

    Names of files, further channels and a shift of all time stamps do not matter.
    """
    names = [name for name in (INPUT, *ANY_OUTPUT) if name in one]
    if names != [name for name in (INPUT, *ANY_OUTPUT) if name in other] or one is other:
        return one is other
    if one.samples != other.samples:
        return False
    blocks = zip(one.blocks(names), other.blocks(names), strict=True)
    return all(np.array_equal(a[name], b[name]) for (_, a), (_, b) in blocks for name in names)


def refuse_same_data(recordings: Sequence[Recording], holdout: Sequence[Recording] = ()) -> None:
    """Refuse data that count twice, or that are held out of a fit that sees them.

    Raises:
        BadInputError: names both files.
    """
    every = [(r, False) for r in recordings] + [(r, True) for r in holdout]
    for (one, one_held), (other, other_held) in combinations(every, 2):
        if same_data(one, other):
            apart = one_held != other_held
            raise BadInputError(
                f"holds the same data as {one.source}"
                + (", which is fitted: it cannot be held out" if apart else ", given twice"),
                where=str(other.source),
                fix="a recording used in the fit cannot validate it: give another one to --holdout"
                if apart
                else "give each recording once",
            )


@contextlib.contextmanager
def within_floating_point(where: str) -> Iterator[None]:
    """Turn arithmetic that broke down on degenerate data into a message.

    Raises:
        BadInputError: in place of numpy's and scipy's errors on singular matrices, NaN and infinity.
    """
    try:
        with np.errstate(all="ignore"):
            yield
    except (np.linalg.LinAlgError, ZeroDivisionError, OverflowError, FloatingPointError) as error:
        raise _broken_down(error, where) from error
    except ValueError as error:
        if not any(word in str(error) for word in ("infs or NaNs", "not finite", "NaN", "non-finite")):
            raise
        raise _broken_down(error, where) from error


def _broken_down(error: Exception, where: str) -> BadInputError:
    return BadInputError(
        f"these data cannot be computed with: {error}",
        where=where,
        fix="look at the channels: are they constant, empty of motion, or in wildly different units?",
    )
