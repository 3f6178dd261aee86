"""Raw frames as the logs that CAN tools read: BLF, ASC, candump and ASAM MDF4 bus logging.

All but MDF4 are written by python-can, frame by frame. Stamps are wall-clock time: that of the bench clock,
from the moment at which it began.
"""

from __future__ import annotations

import contextlib
import datetime
import heapq
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import can
import numpy as np

from hil.core.can.frames import ERROR_FRAME, EXTENDED, SENT_BY_HOST, FrameBlock
from hil.core.errors import BadInputError
from hil.core.files import replacing
from hil.core.recording._evidence import DEVICE
from hil.core.recording._formats import FRAME_LOGS
from hil.core.recording._table import Recording
from hil.core.recording.mdf import tell_header

_FRAME = np.dtype(
    [
        ("CAN_DataFrame.BusChannel", "u1"),
        ("CAN_DataFrame.ID", "<u4"),
        ("CAN_DataFrame.IDE", "u1"),
        ("CAN_DataFrame.DLC", "u1"),
        ("CAN_DataFrame.DataLength", "u1"),
        ("CAN_DataFrame.DataBytes", "u1", (8,)),
        ("CAN_DataFrame.Dir", "u1"),
        ("CAN_DataFrame.EDL", "u1"),
        ("CAN_DataFrame.BRS", "u1"),
        ("CAN_DataFrame.ESI", "u1"),
    ]
)  # names of ASAM MDF bus logging 1.0
_ERROR = np.dtype([("CAN_ErrorFrame.BusChannel", "u1"), ("CAN_ErrorFrame.ID", "<u4")])
_AT_ONCE = 4096


def write_frame_log(frames: Mapping[str, FrameBlock], recording: Recording, path: Path) -> None:
    """Write the frames of all buses to `.blf`, `.asc`, `.log` (candump) or `.mf4`, whole or not at all.

    Buses are channels 1, 2, … in the order of `frames`; candump's text names them.

    Raises:
        BadInputError: there are no frames, or `path` ends otherwise or cannot be written.
        BenchError: the disk is full.
    """
    if not any(len(block) for block in frames.values()):
        raise BadInputError(
            "has no raw frames",
            where=str(recording.source),
            fix="give the recording.mcap of a run: other formats have channels only",
        )
    ending = path.suffix.lower()
    if ending not in (*FRAME_LOGS, ".mf4"):
        raise BadInputError(f"a log of frames ends in {', '.join((*FRAME_LOGS, '.mf4'))}", where=str(path))
    with replacing(path) as temporary:
        if ending == ".mf4":
            _write_mdf(frames, recording, temporary)
            return
        began_s = _bench_clock_0_s(recording)
        with _writer(ending, temporary, began_s) as writer:
            for message in _messages(frames, began_s, named=ending == ".log"):
                writer.on_message_received(message)


def _bench_clock_0_s(recording: Recording) -> float:
    """When the bench clock began, s since 1970; 0 if the recording does not say."""
    with contextlib.suppress(KeyError, ValueError):
        return datetime.datetime.fromisoformat(recording.metadata["time"]["bench_clock_0_at"]).timestamp()
    return 0.0


def _writer(ending: str, path: Path, began_s: float) -> Any:
    if ending == ".blf":
        return can.BLFWriter(path)
    if ending == ".log":
        return can.CanutilsLogWriter(path)
    writer = can.ASCWriter(path)
    writer.file.seek(0)  # python-can has put the time of writing there: the measurement's belongs there
    writer.file.truncate()
    moment = datetime.datetime.fromtimestamp(began_s)
    writer.file.write(f"date {moment:%a %b %d %H:%M:%S}.{moment.microsecond // 1000:03d} {moment:%Y}\n")
    writer.file.write("base hex  timestamps absolute\ninternal events logged\n")
    return writer


def _messages(frames: Mapping[str, FrameBlock], began_s: float, *, named: bool) -> Iterator[can.Message]:
    """Frames of all buses in order of time."""
    buses = [
        _of_bus(block, bus if named else number, began_s)
        for number, (bus, block) in enumerate(frames.items())
    ]
    return heapq.merge(*buses, key=lambda message: message.timestamp)


def _of_bus(block: FrameBlock, channel: str | int, began_s: float) -> Iterator[can.Message]:
    for start in range(0, len(block), _AT_ONCE):
        for time_s, number, flags, length, data in block[start : start + _AT_ONCE].tolist():
            yield can.Message(
                timestamp=began_s + max(0.0, time_s),
                arbitration_id=number,
                is_extended_id=bool(flags & EXTENDED),
                is_error_frame=bool(flags & ERROR_FRAME),
                is_rx=not flags & SENT_BY_HOST,
                dlc=length,
                data=data.to_bytes(8, "little")[:length],
                channel=channel,
            )


def _write_mdf(frames: Mapping[str, FrameBlock], recording: Recording, path: Path) -> None:
    """ASAM bus logging: a group for each bus, with what describes its devices attached."""
    from asammdf import MDF, Signal, Source

    with MDF(version="4.10") as mdf:
        tell_header(mdf, recording, starts_at="bench_clock_0_at")
        for number, (bus, block) in enumerate(frames.items(), 1):
            source = Source(bus, bus, "", Source.SOURCE_BUS, Source.BUS_TYPE_CAN)
            errors = block["flags"] & ERROR_FRAME != 0
            for name, samples, times in (
                ("CAN_DataFrame", _data_frames(block[~errors], number), block["time_s"][~errors]),
                ("CAN_ErrorFrame", _error_frames(block[errors], number), block["time_s"][errors]),
            ):
                if len(times) or name == "CAN_DataFrame":
                    mdf.append(
                        Signal(samples=samples, timestamps=np.maximum(times, 0.0), name=name, source=source),
                        acq_name=bus,
                        comment=f"raw frames of bus '{bus}'",
                    )
        for name, content in recording.attachments.items():
            if name.startswith(DEVICE):
                mdf.attach(content, Path(name).name, comment=name, mime="text/plain")
        mdf.save(path, overwrite=True, compression=2)


def _data_frames(block: FrameBlock, channel: int) -> np.ndarray[Any, Any]:
    """As MDF has them: length codes and lengths are the same up to 8 bytes."""
    rows = np.zeros(len(block), _FRAME)
    rows["CAN_DataFrame.BusChannel"] = channel
    rows["CAN_DataFrame.ID"] = block["id"]
    rows["CAN_DataFrame.IDE"] = block["flags"] & EXTENDED != 0
    rows["CAN_DataFrame.DLC"] = rows["CAN_DataFrame.DataLength"] = block["length"]
    rows["CAN_DataFrame.DataBytes"] = np.ascontiguousarray(block["data"]).view("u1").reshape(-1, 8)
    rows["CAN_DataFrame.Dir"] = block["flags"] & SENT_BY_HOST != 0
    return rows


def _error_frames(block: FrameBlock, channel: int) -> np.ndarray[Any, Any]:
    rows = np.zeros(len(block), _ERROR)
    rows["CAN_ErrorFrame.BusChannel"] = channel
    rows["CAN_ErrorFrame.ID"] = block["id"]
    return rows
