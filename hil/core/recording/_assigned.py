"""Columns of a file as channels: found by name, converted, and what was understood kept for the reader."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from hil.core.channels import CHANNELS, TIME, unit_of
from hil.core.errors import BadInputError
from hil.core.errors.wording import closest, printable
from hil.core.recording._column_map import AS_NAMED, OPTION, ColumnMap, Source, fix_of, wanted_unit
from hil.core.recording._table import Array
from hil.core.recording._table_clock import refuse_sentinel
from hil.core.units import UnitError, conversion, has_unit

_MOST_LISTED = 20
_WITHOUT_UNIT = re.compile(r"(.+?)\s*[\[(]([^\[\]()]*)[\])]")
_PARTS = re.compile(r"[/\\|]|(?<=[^.])\.(?=[^.])")


@dataclass
class Assigned:
    """The columns of one file and the channels that they are.

    Attributes:
        channels: by column, the channel or the name that it keeps; '' where it is left out.
        units: by channel, the unit that stands beside the column's name.
        understood: by channel of the map, what it was computed from; for people and `--json`.
        own: this software exported the file: each number means what it says.
    """

    channels: list[str]
    where: str
    columns: ColumnMap = AS_NAMED
    units: dict[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    understood: dict[str, dict[str, Any]] = field(default_factory=dict)
    own: bool = False

    def convert(self, values: Array, channel: str, unit: str, where: str) -> Array:
        """A column's cells in the unit of its channel; `unit` is what the file says, or ''.

        Time is converted like any channel; a derivative is formed later, when time is known.

        Raises:
            BadInputError: the unit cannot be converted.
        """
        source = self.columns.sources.get(channel)
        unit = unit or self.units.get(channel, "")
        decided = self.own or (source is not None and source.missing is not None)
        if channel != TIME and not decided and (source is not None or channel in CHANNELS):
            refuse_sentinel(values, channel, where)
        if source is None and (channel not in CHANNELS or not has_unit(unit)):
            return values
        chosen = source or Source(channel)
        given = chosen.unit or unit
        wanted = wanted_unit(channel, chosen)
        try:
            found = conversion(given, wanted) if has_unit(given) else conversion(wanted, wanted)
        except UnitError as error:
            raise BadInputError(error.what, where=where, fix=fix_of(given, wanted, error)) from None
        if source is None:
            if not found.is_none:
                self.notes.append(f"'{channel}' was converted from {_bare(given)} to {wanted}")
            return found.of(values)
        values = np.array(values, np.float64)
        for cell in source.missing or ():
            values[values == cell] = np.nan
        if source.wraps:
            _refuse_beyond(values, source.wraps, where)
            values = _unwrapped(values, source.wraps)
        values = values * source.scale + source.offset
        values = found.of(values) * (source.sign * _past_gear(channel, source.gear))
        self._understand(channel, source, given, unit, wanted)
        return values

    def _understand(self, channel: str, source: Source, given: str, in_file: str, wanted: str) -> None:
        entry = source.as_json()
        entry["column"] = self.understood.get(channel, {}).get("column", source.column)
        entry["unit"] = _bare(given) if has_unit(given) else wanted
        parts = [f"'{channel}' is column '{printable(entry['column'], 60)}'"]
        if not has_unit(given):
            entry["unit_guessed"] = True
            parts.append(f"which names no unit: it was taken to be in {wanted}")
        elif entry["unit"] != wanted:
            parts.append(f"converted from {entry['unit']} to {wanted}")
        if source.unit and has_unit(in_file) and _bare(in_file) != _bare(source.unit):
            parts.append(f"though the file says {_bare(in_file)}")
        for key in ("sign", "scale", "offset", "gear", "wraps", "missing", "derivative"):
            if key in entry:
                value = entry[key]
                text = " ".join(f"{one:g}" for one in value) if isinstance(value, tuple) else f"{value:g}"
                parts.append(key if value is True else f"{key} {text}")
        entry = {key: list(value) if isinstance(value, tuple) else value for key, value in entry.items()}
        self.understood[channel] = entry
        self.notes.append(", ".join(parts))

    def finish(self, channels: dict[str, Array]) -> dict[str, Array]:
        """Form what needs the whole table: time that is counted, and slopes.

        Raises:
            BadInputError: time is both counted and a column.
        """
        every_s = self.columns.every_s
        if every_s and channels:
            samples = len(next(iter(channels.values())))
            counted: Array = np.arange(samples, dtype=np.float64) * every_s
            _refuse_other_pace(channels.get(TIME), every_s)
            channels = {
                TIME: counted,
                **{n: v for n, v in channels.items() if n != TIME},
            }
            self.understood[TIME] = {"every_s": every_s}
            self.notes.append(f"time was counted: a sample every {every_s:g} s")
        for channel, source in self.columns.columns():
            if source.derivative and channel in channels and TIME in channels:
                channels[channel] = _slope(channels[channel], channels[TIME])
        return channels


def assigned(names: Sequence[str], columns: ColumnMap, where: str) -> Assigned:
    """Which of a file's columns are which channels.

    A column is found by its whole name; else, if there is only one, by its name without case, without a unit
    in brackets, or by the last part of a path (`Model Root/n_EM`, `nmot\\ETKC:1`); the notes say so.

    Raises:
        BadInputError: a column of the map is not in the file, or several may be meant.
    """
    found = Assigned([name.strip() for name in names], where, columns)
    taken: dict[int, str] = {}
    for channel, source in columns.columns():
        number = _place(source.column, found.channels, where)
        name = found.channels[number]
        taken[number] = channel
        found.understood[channel] = {"column": name}
        bracketed = _WITHOUT_UNIT.fullmatch(name)
        if bracketed and has_unit(bracketed[2]):
            found.units[channel] = bracketed[2]
        if name != source.column and not (bracketed and bracketed[1] == source.column):
            found.notes.append(f"'{printable(source.column, 60)}' was taken to be '{printable(name, 60)}'")
    for number, name in enumerate(found.channels):
        if number in taken:
            found.channels[number] = taken[number]
        elif name in columns.sources:
            found.notes.append(f"column '{name}' was left out: {OPTION} gives the channel another one")
            found.channels[number] = ""
    return found


def is_there(column: str, names: Sequence[str]) -> bool:
    """Whether a file with columns of these names has a column, or more than one that may be meant."""
    return bool(_candidates(column, names))


def _place(column: str, names: Sequence[str], where: str) -> int:
    candidates = _candidates(column, names)
    if len(candidates) == 1:
        return candidates[0]
    shown = printable(column, 60)
    if candidates:
        listed = ", ".join(f"'{printable(names[number], 60)}'" for number in candidates[:_MOST_LISTED])
        raise BadInputError(f"column '{shown}' may be {listed}", where=where, fix="give the whole name")
    close = closest(column, names)
    hint = f"did you mean '{printable(close, 60)}'? " if close else ""
    raise BadInputError(f"has no column '{shown}'", where=where, fix=f"{hint}it has: {listing(names)}")


def listing(names: Iterable[str]) -> str:
    """Names of columns for a message, as many as somebody reads."""
    known = [printable(name, 60) for name in names if name]
    further = f" and {len(known) - _MOST_LISTED} more" if len(known) > _MOST_LISTED else ""
    return f"{', '.join(known[:_MOST_LISTED])}{further}" or "none"


def _candidates(column: str, names: Sequence[str]) -> list[int]:
    """Numbers of the columns that may be meant, by the strictest rule that any fits."""
    rules = (
        lambda name: name == column,
        lambda name: name.lower() == column.lower(),
        lambda name: _bare_name(name) == _bare_name(column),
        lambda name: _bare_name(column) in [_bare_name(part) for part in _PARTS.split(name)],
    )
    bare = _bare_name(column)
    near = [number for number, name in enumerate(names) if name and bare in name.lower()]
    for fits in rules:
        candidates = [number for number in near if fits(names[number])]
        if candidates:
            return candidates
    return []


def _bare_name(name: str) -> str:
    bracketed = _WITHOUT_UNIT.fullmatch(name.strip())
    return (bracketed[1] if bracketed else name).strip().strip('"').lower()


def _bare(unit: str) -> str:
    return printable(unit.strip().strip('"').strip("[]()").strip(), 40)


def _past_gear(channel: str, gear: float) -> float:
    """Factor from one shaft of a gear to the other, speed over `gear` being the slower one's."""
    return gear if unit_of(channel) == "N m" else 1.0 / gear


def _refuse_other_pace(time_s: Array | None, every_s: float) -> None:
    """Stamps may be rounded or repeat; they do not take another time altogether."""
    if time_s is None or len(time_s) < 2:
        return
    took_s = float(np.nanmax(time_s) - np.nanmin(time_s))
    counted_s = every_s * (len(time_s) - 1)
    if took_s > 0 and not 0.9 < counted_s / took_s < 1.1:
        raise BadInputError(
            f"every_s = {every_s:g} makes {counted_s:g} s, the column of time goes over {took_s:g} s",
            where=TIME,
            fix="leave every_s out, or write 'time_s=, every_s=…' if the column is no time",
        )


def _refuse_beyond(values: Array, span: float, where: str) -> None:
    """Cells of a counter cover no more than the range after which it begins again."""
    there = values[np.isfinite(values)]
    covered = float(np.ptp(there)) if len(there) else 0.0
    if covered > span or (len(there) and np.max(np.abs(there)) > 2 * span):
        raise BadInputError(
            f"wraps is {span:g}, its cells go from {np.min(there):g} to {np.max(there):g}",
            where=where,
            fix="give the range after which it begins again, in the column's own numbers",
        )


def _unwrapped(values: Array, span: float) -> Array:
    """A counter or position that begins again after `span`, as one that goes on; missing cells stay."""
    there = np.isfinite(values)
    values = values.copy()
    values[there] = np.unwrap(values[there], period=span)
    return values


def _slope(values: Array, time_s: Array) -> Array:
    """Central differences, one-sided at the ends: no filter, so that noise is the reader's to judge."""
    if len(values) < 2:
        return np.full(len(values), np.nan)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.gradient(values, time_s))
