"""Frames kept in recordings: ASAM MDF bus logging, read in whole columns, and the project's own."""

from __future__ import annotations

import contextlib
import datetime
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from hil.core.can.frames import ERROR_FRAME, EXTENDED, SENT_BY_HOST, FrameBlock
from hil.core.can_logs._log import LONG, LONGEST_DATA, REMOTE, CanLog, block_of, ordered
from hil.core.errors import BadInputError
from hil.core.recording import read_as_written, read_frames
from hil.core.recording.mdf import open_mdf

_DATA, _ERROR, _REMOTE = "CAN_DataFrame", "CAN_ErrorFrame", "CAN_RemoteFrame"  # ASAM MDF bus logging 1.0
_EXTENDED_BIT = 0x8000_0000
_ID_MASK = 0x1FFF_FFFF
_LARGEST_STANDARD = 0x7FF

Column = npt.NDArray[Any]


def read_mdf_frames(path: Path) -> CanLog:
    """Frames of all CAN channels of an MDF4 file.

    Raises:
        BadInputError: no MDF file or a broken one, or one that holds no frames.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with open_mdf(path) as mdf:
                log = _read(mdf, path)
    except BadInputError:
        raise
    except Exception as error:  # of many kinds, for whatever is broken
        raise BadInputError("not an MDF file, or a broken one", where=str(path)) from error
    if not log.channels and not log.left_out:
        raise BadInputError(
            "holds channels and no CAN frames",
            where=str(path),
            fix="it needs no decoding: give it to hil report, or any command that takes a recording",
        )
    return log


def _read(mdf: Any, path: Path) -> CanLog:
    parts: dict[str, list[FrameBlock]] = {}
    left_out: dict[str, int] = {}
    for index, group in enumerate(mdf.groups):
        names = {str(channel.name) for channel in group.channels}
        cycles = int(group.channel_group.cycles_nr)
        if _REMOTE in names and cycles:
            left_out[REMOTE] = left_out.get(REMOTE, 0) + cycles
        for kind in (_DATA, _ERROR):
            if kind in names and cycles:
                for name, block, long in _of_group(mdf, index, kind, names):
                    parts.setdefault(name, []).append(block)
                    if long:
                        left_out[LONG] = left_out.get(LONG, 0) + long
    channels = {name: ordered(np.concatenate(blocks)) for name, blocks in sorted(parts.items())}
    began_ns = round(mdf.header.start_time.timestamp() * 1e6) * 1000
    return CanLog(
        path, {name: block for name, block in channels.items() if len(block)}, began_ns or None, left_out
    )


def _of_group(mdf: Any, index: int, kind: str, names: set[str]) -> Iterator[tuple[str, FrameBlock, int]]:
    """Channel, frames, and how many were left out for their length."""
    columns = _Columns(mdf, index, kind, names)
    times = columns.times
    numbers = columns.get("ID", 0).astype(np.int64)
    flagged = columns.get("IDE", 0).astype(bool) | (numbers & _EXTENDED_BIT != 0)
    numbers &= _ID_MASK
    extended = flagged | (numbers > _LARGEST_STANDARD)
    flags = EXTENDED * extended.astype(np.uint8) + SENT_BY_HOST * columns.sent().astype(np.uint8)
    if kind == _ERROR:
        flags += np.uint8(ERROR_FRAME)
        lengths, data = np.zeros(len(times), np.int64), np.zeros(len(times), np.uint64)
    else:
        lengths, data = columns.payloads()
    buses = columns.get("BusChannel", 1).astype(np.int64)
    fits = lengths <= LONGEST_DATA
    for bus in np.unique(buses).tolist():
        its = buses == bus
        chosen = its & fits
        block = block_of(times[chosen], numbers[chosen], flags[chosen], lengths[chosen], data[chosen])
        yield str(bus), block, int(np.count_nonzero(its & ~fits))


class _Columns:
    """The parts of one kind of frames in a group."""

    def __init__(self, mdf: Any, index: int, kind: str, names: set[str]) -> None:
        whole = mdf.get(kind, group=index, raw=True)
        self.times = np.asarray(whole.timestamps, np.float64)
        self._whole, self._kind = whole.samples, kind
        self._fields = whole.samples.dtype.names or ()
        self._mdf, self._index, self._names = mdf, index, names

    def get(self, part: str, default: int | None = None) -> Column:
        """One part of each frame; `default` where the log has none."""
        name = f"{self._kind}.{part}"
        if name in self._fields:
            return np.asarray(self._whole[name])
        if name in self._names:
            return np.asarray(self._mdf.get(name, group=self._index, raw=True).samples)
        if default is None:
            raise ValueError(f"no {name}")
        return np.full(len(self.times), default)

    def sent(self) -> Column:
        """Whether each frame was sent by who logged it; Dir is a number, or text of its value."""
        direction = self.get("Dir", 0)
        if direction.dtype.kind in "SU":
            return np.asarray(np.char.lower(direction.astype("S2")) == b"tx")
        return direction.astype(bool)

    def payloads(self) -> tuple[Column, Column]:
        """Length and data of each frame; data of those that are longer than 8 bytes is cut."""
        length = "DataLength" if f"{self._kind}.DataLength" in self._names else "DLC"
        data = self.get("DataBytes")
        if data.dtype.kind == "S" or data.dtype.kind == "V":
            data = np.ascontiguousarray(data).view(np.uint8).reshape(len(data), -1)
        payloads = np.zeros((len(data), LONGEST_DATA), np.uint8)
        kept = min(LONGEST_DATA, data.shape[1])
        payloads[:, :kept] = data[:, :kept]
        lengths = self.get(length).astype(np.int64)
        payloads[np.arange(LONGEST_DATA) >= lengths[:, None]] = 0
        return lengths, payloads.view("<u8")[:, 0]


def read_own(path: Path) -> CanLog:
    """The frames of each bus; the bench clock is that of their stamps."""
    recording = read_as_written(path)
    began_ns = None
    with contextlib.suppress(KeyError, ValueError):
        moment = datetime.datetime.fromisoformat(recording.metadata["time"]["bench_clock_0_at"])
        began_ns = round(moment.timestamp() * 1e3) * 1_000_000
    frames = {bus: ordered(block) for bus, block in read_frames(path).items() if len(block)}
    return CanLog(path, frames, began_ns, remarks=tuple(recording.damage))
