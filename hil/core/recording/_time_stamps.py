"""Time that stands in a table as text: dates with a time of day, or a time of day alone."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as compute

from hil.core.recording._table import Array

_DAY_S = 86_400.0
_CLOCK = (
    r"(?P<h>\d{1,2}):(?P<m>\d{2})(?::(?P<s>\d{2})(?:[.,:](?P<f>\d{1,9}))?)?\s*(?P<p>[AaPp][Mm])?"
    r"\s*(?:Z|UTC|[+-]\d{2}:?\d{2})?"
)
_DATE = r"(?P<a>\d{1,4})(?P<sign>[-./])(?P<b>\d{1,2})[-./](?P<c>\d{1,4})"
_STAMP = re.compile(rf"\s*(?:{_DATE}[T\s]\s*)?{_CLOCK}\s*")
#: The same for RE2, which Arrow uses: one expression over a whole column.
_COLUMN = rf"^\s*(?:{_DATE}[T\s]\s*)?{_CLOCK}\s*$"


@dataclass
class TimeStamps:
    """Reads a column of such stamps, block by block, as seconds since the first.

    A time of day that goes back by more than half a day has passed midnight. Of dates with slashes of which
    no part is above 12, month and day cannot be distinguished: that matters only where the date changes.
    """

    first_day: int | None = None
    notes: list[str] = field(default_factory=list)
    first_s: float = np.nan
    last_s: float = np.nan
    added_s: float = 0.0

    def seconds(self, cells: Any) -> Array:
        """Seconds of the stamps of an Arrow array of text; NaN of those that are missing.

        Raises:
            ValueError: a cell is no stamp; its argument is the cell and its number.
        """
        parts = compute.extract_regex(cells, _COLUMN)
        there = np.asarray(parts.is_valid().to_numpy(zero_copy_only=False), bool)
        given = np.asarray(cells.is_valid().to_numpy(zero_copy_only=False), bool)
        if (given & ~there).any():
            row = int((given & ~there).argmax())
            raise ValueError(str(cells[row]), row)
        clock = _number(parts, "h") * 3600 + _number(parts, "m") * 60 + _number(parts, "s")
        clock += _fraction(parts) + _afternoon(parts)
        found = clock + self._days(parts, there) * _DAY_S
        return self._since_first(np.where(there, found, np.nan))

    def _days(self, parts: Any, there: Array) -> Array:
        a, b, c = (_number(parts, name).astype(np.int64) for name in "abc")
        if not (a > 0).any():
            return np.zeros(len(a))
        if int(a.max()) > 31:
            year, month, day = a, b, c
        else:
            slashes = compute.struct_field(parts, "sign")[int(np.argmax(there))].as_py() == "/"
            month_first = slashes and int(a.max()) <= 12
            year, month, day = c, (a if month_first else b), (b if month_first else a)
            if slashes and int(b.max()) <= 12 and month_first:
                note = "dates with slashes were read as month/day/year"
                self.notes = self.notes if note in self.notes else [*self.notes, note]
        year = np.where(year < 100, year + 2000, year)
        if int(month.max()) > 12 or int(day.max()) > 31:
            raise ValueError("a date that is none", 0)
        months = (year - 1970) * 12 + month - 1
        days = months.astype("datetime64[M]").astype("datetime64[D]").astype(np.int64) + day - 1
        if self.first_day is None and there.any():
            self.first_day = int(days[int(np.argmax(there))])
        return np.asarray((days - (self.first_day or 0)).astype(np.float64))

    def _since_first(self, found: Array) -> Array:
        if self.first_day is None:
            found = self._past_midnight(found)
        there = np.isfinite(found)
        if np.isnan(self.first_s) and there.any():
            self.first_s = float(found[there][0])
        return found - self.first_s

    def _past_midnight(self, found: Array) -> Array:
        there = np.flatnonzero(np.isfinite(found))
        known = found[there]
        steps = np.diff(known, prepend=self.last_s if not np.isnan(self.last_s) else known[:1])
        passed = steps < -0.5 * _DAY_S
        if passed.any():
            note = "the time of day passes midnight: stamps behind it are of the next day"
            self.notes = [*self.notes, note]
        found = found.copy()
        found[there] = known + self.added_s + _DAY_S * np.cumsum(passed)
        self.added_s += _DAY_S * float(np.count_nonzero(passed))
        self.last_s = float(known[-1]) if len(known) else self.last_s
        return found


def is_stamp(cell: str) -> bool:
    """Whether a cell is a date with a time of day, or a time of day."""
    return _STAMP.fullmatch(cell.strip().strip('"')) is not None


def kind_of(cell: str) -> str:
    """What a stamp is, in words."""
    found = _STAMP.fullmatch(cell.strip().strip('"'))
    return "date and time of day" if found and found["a"] else "time of day"


def _text(parts: Any, name: str) -> Any:
    return compute.fill_null(compute.struct_field(parts, name), "")


def _number(parts: Any, name: str) -> Array:
    text = _text(parts, name)
    filled = compute.if_else(compute.equal(text, ""), "0", text)
    return np.asarray(compute.cast(filled, pa.float64()).to_numpy(zero_copy_only=False))


def _fraction(parts: Any) -> Array:
    text = compute.binary_join_element_wise("0.", _text(parts, "f"), "0", "")
    return np.asarray(compute.cast(text, pa.float64()).to_numpy(zero_copy_only=False))


def _afternoon(parts: Any) -> Array:
    """Seconds to add for AM and PM: noon is 12 PM, midnight 12 AM."""
    half = compute.utf8_lower(_text(parts, "p"))
    twelve = _number(parts, "h") == 12
    is_pm = np.asarray(compute.equal(half, "pm").to_numpy(zero_copy_only=False), bool)
    is_am = np.asarray(compute.equal(half, "am").to_numpy(zero_copy_only=False), bool)
    return np.where(is_pm & ~twelve, 43_200.0, 0.0) - np.where(is_am & twelve, 43_200.0, 0.0)
