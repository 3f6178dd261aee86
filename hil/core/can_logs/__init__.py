"""Logs of CAN frames as other tools write them, read into blocks (docs/how-to/replay.md)."""

from __future__ import annotations

import logging
from pathlib import Path

from hil.core.can_logs._log import CanLog, Stamps
from hil.core.errors import BadInputError
from hil.core.recording import refuse_unless_regular

logger = logging.getLogger(__name__)

#: Endings of the logs that are read: own recordings, Vector's two, PEAK's, candump's, ASAM MDF bus logging.
READ = (".mcap", ".asc", ".blf", ".trc", ".log", ".mf4")


def read_can_log(path: Path, stamps: Stamps = "") -> CanLog:
    """Read the frames of a log, by the channels that it has.

    Args:
        stamps: what it means that stamps go back in a log that is written frame by frame.

    Raises:
        BadInputError: there is no such file, it is of another kind, or not one frame of it can be read.
    """
    refuse_unless_regular(path)
    match path.suffix.lower():
        case ".mcap":
            from hil.core.can_logs._mdf import read_own

            log = read_own(path)
        case ".mf4":
            from hil.core.can_logs._mdf import read_mdf_frames

            log = read_mdf_frames(path)
        case ".asc" | ".blf" | ".trc" | ".log":
            from hil.core.can_logs._python_can import read_messages

            log = read_messages(path, stamps)
        case _:
            raise BadInputError(
                f"logs of frames end in {', '.join(READ)}", where=str(path), fix="rename or convert the file"
            )
    if not log.channels:
        fix = f"{_left_out_in_words(log)}give a log of frames"
        raise BadInputError("has no data frames", where=str(path), fix=fix)
    logger.info("read %s: %d frames, %d channels", path, log.count, len(log.channels))
    return log


def _left_out_in_words(log: CanLog) -> str:
    left_out = ", ".join(f"{count} {kind}" for kind, count in log.left_out.items())
    return f"it has {left_out}; " if left_out else ""


__all__ = ["READ", "CanLog", "Stamps", "read_can_log"]
