"""What all tables of other tools go through once their columns are channels: time, rates, sentinels."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from hil.core.channels import CHANNELS, INPUT, TIME, unit_of
from hil.core.errors import BadInputError
from hil.core.recording._assigned import Assigned, assigned
from hil.core.recording._column_map import ColumnMap
from hil.core.recording._table import Array, Recording
from hil.core.recording._table_clock import counted_on, evenly_placed, of_one_rate

#: Metadata table of a recording whose columns were assigned: by channel, JSON of what was understood.
COLUMNS = "columns"


@dataclass(frozen=True)
class Column:
    """Values of a column with the unit that the file says, and their own time in s, or None."""

    values: Array
    unit: str = ""
    time_s: Array | None = None


def settled(
    channels: dict[str, Array], path: Path, found: Assigned | None, notes: list[str], *, own: bool = False
) -> Recording:
    """The recording of a table, with what had to be assumed among its notes.

    Args:
        own: this software exported it: its stamps, blanks and numbers mean what they say.

    Raises:
        BadInputError: stamps or numbers that can be read in two ways.
    """
    if found is not None:
        channels = found.finish(channels)
        notes += found.notes
    if own:
        return Recording(channels, path, notes=notes)
    if TIME in channels:
        channels[TIME] = evenly_placed(channels[TIME], str(path), notes)
    channels = of_one_rate(channels, notes)
    recording = Recording(channels, path, notes=notes)
    if found is not None and found.understood:
        recording.metadata[COLUMNS] = {name: json.dumps(entry) for name, entry in found.understood.items()}
    return recording


def columns_of(recording: Recording) -> dict[str, Any]:
    """By channel, from which column of the file it was computed and how; empty if no map was given."""
    table = recording.metadata.get(COLUMNS, {})
    try:
        return {name: json.loads(text) for name, text in table.items()}
    except ValueError:  # of a file that somebody edited
        return {}


def assigned_signals(
    signals: Mapping[str, Array], units: Mapping[str, str], columns: ColumnMap
) -> tuple[dict[str, Array], dict[str, str], dict[str, Any], list[str]]:
    """Signals of decoded frames as channels: their values, their units, what was understood, and notes.

    `signals` holds `time_s` of the rows; values are missing where no frame has them.

    Raises:
        BadInputError: a signal of the map is not there, or its unit cannot be converted.
    """
    found = assigned(list(signals), columns, "the logs")
    channels: dict[str, Array] = {}
    for channel, (name, values) in zip(found.channels, signals.items(), strict=True):
        if channel:
            channels[channel] = found.convert(values, channel, units.get(name, ""), f"signal '{name}'")
    channels = found.finish(channels)
    known = {
        channel: unit_of(channel) if channel in columns.sources else units.get(channel, "")
        for channel in channels
        if channel in columns.sources or channel in units
    }
    return channels, known, found.understood, found.notes


def recording_of(
    table: Mapping[str, Column],
    path: Path,
    columns: ColumnMap,
    kind: str,
    notes: list[str],
    *,
    own: bool = False,
) -> Recording:
    """The recording of columns that were read whole; those with stamps of their own come to the input's.

    Args:
        kind: what the file calls a column, for messages.
        own: this software exported it.

    Raises:
        BadInputError: a known channel of another length, a column of the map that is not there, a unit that
            cannot be converted.
    """
    names = [_known(name) for name in table]
    found = assigned(names, columns, str(path)) if columns else Assigned(names, str(path))
    found.own = own
    channels: dict[str, Array] = {}
    times: dict[str, Array] = {}
    for channel, (name, column) in zip(found.channels, table.items(), strict=True):
        if not channel:
            continue
        if channel in channels:
            if channel in CHANNELS or channel in columns.sources:
                raise BadInputError(f"{kind} '{channel}' stands twice", where=str(path))
            notes.append(f"{kind} '{channel}' stands twice; the first was taken")
            continue
        values = counted_on(column.values, notes) if channel == TIME else column.values
        channels[channel] = found.convert(values, channel, column.unit, f"{path}: {kind} '{name}'")
        if column.time_s is not None:
            times[channel] = column.time_s
    if TIME not in channels and times and not columns.every_s:
        channels[TIME] = times[INPUT] if INPUT in times else next(iter(times.values()))
    channels = _at_one_time(channels, times, found, f"{path}: {kind}")
    channels = _of_one_length(channels, path, kind, found)
    return settled(channels, path, found, notes, own=own)


def _known(name: str) -> str:
    """A name in capitals is the channel's."""
    return name.strip().lower() if name.strip().lower() in CHANNELS else name.strip()


def _at_one_time(
    channels: dict[str, Array], times: Mapping[str, Array], found: Assigned, where: str
) -> dict[str, Array]:
    """Columns with stamps of their own, interpolated at those of the recording; missing outside of theirs."""
    time_s = channels.get(TIME)
    if time_s is None:
        return channels
    for name, own_s in times.items():
        if name == TIME or np.array_equal(own_s, time_s):
            continue
        if len(own_s) != len(channels[name]) or len(own_s) == 0 or np.any(np.diff(own_s) <= 0):
            if name in CHANNELS:
                raise BadInputError(
                    "has time stamps of its own that do not increase", where=f"{where} '{name}'"
                )
            found.notes.append(f"'{name}' has time stamps that do not increase and was left out")
            channels[name] = np.zeros(0)
            continue
        found.notes.append(f"'{name}' was interpolated at the time stamps of '{INPUT}'")
        channels[name] = np.interp(time_s, own_s, channels[name], left=np.nan, right=np.nan)
    return channels


def _of_one_length(channels: dict[str, Array], path: Path, kind: str, found: Assigned) -> dict[str, Array]:
    """Those as long as the time, or as the input where time is counted; all known ones have to be."""
    lead = TIME if TIME in channels else INPUT if found.columns.every_s else ""
    if lead not in channels:
        return channels
    samples = len(channels[lead])
    for name, values in channels.items():
        if len(values) == samples:
            continue
        if name in CHANNELS:
            raise BadInputError(
                f"has {len(values)} values, {lead} has {samples}",
                where=f"{path}: {kind} '{name}'",
                fix="save vectors of one length",
            )
        found.notes.append(f"{kind} '{name}' is not as long as {lead} and was left out")
    return {name: values for name, values in channels.items() if len(values) == samples}
