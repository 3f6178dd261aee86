"""Every signal of a DBC as a channel, for logs of benches that have no bench file."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt

from hil.core.can.dbc_messages import (
    MessageLayout,
    MessageSamples,
    decoded,
    for_addresses,
    keys_of,
    of_other_addresses,
    read_messages_of,
)
from hil.core.can.frames import FrameBlock
from hil.core.channels import TIME
from hil.core.errors import BadInputError
from hil.core.recording import AS_NAMED, ColumnMap, RecordingWriter, assigned_signals
from hil.engine.bench.device_kinds import descriptions_of
from hil.engine.replay._channels import Frames, listed

Array = npt.NDArray[np.float64]
_NEAREST_WITHIN = 2.5  # distances of rows; beyond, a sample stands in none
_ROWS_AT_ONCE = 65536


class DbcDecoder:
    """Decodes the frames of each channel with the DBC that was given for it, or for all.

    Args:
        dbcs: file by channel of the logs; under '' the one for all others.
        columns: which signals are which channels.

    Raises:
        BadInputError: a DBC that cannot be used, a channel that is not there, or no frame that is known.

    Attributes:
        short: frames that end before a signal that should be in them.
        understood: by channel of `columns`, JSON of the signal and how it was converted.
    """

    def __init__(self, frames: Frames, dbcs: Mapping[str, Path], columns: ColumnMap = AS_NAMED) -> None:
        self._map = columns
        self.understood: dict[str, str] = {}
        self.remarks: list[str] = []
        self.attachments: dict[str, bytes] = {}
        self.units: dict[str, str] = {}
        self._frames: dict[str, FrameBlock] = {}
        self._layouts: dict[str, list[MessageLayout]] = {}
        layouts: dict[str, list[MessageLayout]] = {}
        for channel, path in dbcs.items():
            layouts[channel], remarks = read_messages_of(path)
            self.remarks += [f"{path.name}: {remark}" for remark in remarks]
            self.attachments |= descriptions_of(channel or "can", [path])
            if channel and frames.of(channel) is None:
                raise BadInputError(
                    f"--dbc {channel}={path}: no log has a channel '{channel}'",
                    fix=f"there is: {listed(frames, {})}",
                )
        found: list[tuple[str, MessageSamples]] = []
        for channel in frames.names:
            block = frames.of(channel)
            assert block is not None
            self._frames[_plain(channel)] = block
            given = layouts.get(channel) or layouts.get("", [])
            own, remarks = for_addresses(given, np.unique(keys_of(block)).tolist())
            self.remarks += remarks
            self._layouts[channel] = own
            found += [(_plain(channel), samples) for samples in decoded(block, own)]
        self.short = sum(samples.short for _, samples in found)
        if not found:
            names = ", ".join(str(path) for path in dbcs.values())
            raise BadInputError(
                f"no frame in the log is described by {names}",
                fix=f"give the DBC of these logs; there is: {listed(frames, {})}",
            )
        self._found = found

    def keys_of(self, file: str, channel: str) -> list[int]:
        """Keys of the messages by which a channel of a log is decoded."""
        del file
        return [layout.key for layout in self._layouts.get(channel, [])]

    def about_unknown(self, unknown: Mapping[str, int]) -> list[str]:
        """Why frames that are counted as of no message are not of one that only looks like theirs."""
        return of_other_addresses([one for own in self._layouts.values() for one in own], unknown)

    def write(self, path: Path, began_ns: int) -> RecordingWriter:
        """Write frames and channels into a recording that is not closed yet.

        Rows are the frames of the message that came most often; a sample of any other stands once, in the row
        nearest to it.

        Raises:
            BenchError: the disk is full.
        """
        base = max((samples for _, samples in self._found), key=lambda samples: len(samples.time_s))
        rows_s = base.time_s[np.concatenate([[True], np.diff(base.time_s) > 0])]
        columns: dict[str, Array] = {TIME: rows_s - rows_s[0]}
        beside = 0
        for name, samples, signal in self._named():
            columns[name], missed = _placed(rows_s, samples.time_s, samples.values[signal])
            beside += missed
            self.units[name] = samples.layout.unit(signal)
        columns = self._as_channels(columns)
        if beside:
            self.remarks.append(
                f"{beside} samples were discarded: none of the rows is near, or another sample is nearer"
            )
        self.remarks.append(f"the time base is the frames of '{base.layout.name}'")
        writer = RecordingWriter(path, list(columns), list(self._frames), clock_0_ns=began_ns)
        writer.row_0_s = float(rows_s[0])
        self._fill(writer, columns, rows_s)
        return writer

    def _as_channels(self, columns: dict[str, Array]) -> dict[str, Array]:
        """Signals that the map names, under their channels' names and in their units."""
        if not self._map:
            return columns
        found, self.units, understood, notes = assigned_signals(columns, self.units, self._map)
        self.understood = {name: json.dumps(entry) for name, entry in understood.items()}
        self.remarks += notes
        return found

    def _fill(self, writer: RecordingWriter, columns: dict[str, Array], rows_s: Array) -> None:
        """Frames and rows by turns, so that messages are in order of time."""
        for start in range(0, len(rows_s), _ROWS_AT_ONCE):
            stop = start + _ROWS_AT_ONCE
            since_s = -np.inf if start == 0 else rows_s[start]
            until_s = rows_s[stop] if stop < len(rows_s) else np.inf
            for bus, block in self._frames.items():
                first, last = np.searchsorted(block["time_s"], (since_s, until_s))
                writer.add_frames(bus, block[first:last])
            writer.add_rows(np.column_stack([column[start:stop] for column in columns.values()]))

    def _named(self) -> Sequence[tuple[str, MessageSamples, str]]:
        """Each signal with a name of its own, if need be with its message's or with its bus's."""
        every = [(bus, samples, signal) for bus, samples in self._found for signal in samples.values]
        short = Counter(_plain(signal) for _, _, signal in every)
        middle = Counter(_plain(f"{samples.layout.name}_{signal}") for _, samples, signal in every)
        named = []
        for bus, samples, signal in every:
            own, longer = _plain(signal), _plain(f"{samples.layout.name}_{signal}")
            name = own if short[own] == 1 else longer if middle[longer] == 1 else f"{bus}_{longer}"
            named.append((name, samples, signal))
        return named


def _placed(rows_s: Array, times_s: Array, values: Array) -> tuple[Array, int]:
    """A channel on the rows, NaN where nothing was measured; how many of its samples stand in none."""
    column = np.full(len(rows_s), np.nan)
    known = ~np.isnan(values)  # a multiplexed signal is not in every frame
    times_s, values = times_s[known], values[known]
    after = np.clip(np.searchsorted(rows_s, times_s), 1, max(1, len(rows_s) - 1))
    before = after - 1
    after = np.minimum(after, len(rows_s) - 1)
    nearest = np.where(times_s - rows_s[before] <= rows_s[after] - times_s, before, after)
    within_s = _NEAREST_WITHIN * float(np.median(np.diff(rows_s))) if len(rows_s) > 1 else np.inf
    near = np.abs(rows_s[nearest] - times_s) <= within_s
    column[nearest[near]] = values[near]
    return column, len(values) - int(np.count_nonzero(~np.isnan(column)))


def _plain(name: str) -> str:
    """A name that a channel and a topic may have."""
    plain = re.sub(r"\W", "_", name, flags=re.ASCII)
    return plain if plain[:1].isalpha() or plain[:1] == "_" else f"can{plain}"
