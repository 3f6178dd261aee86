"""Recordings: what was measured, in memory and on disk (docs/reference/recordings.md)."""

from __future__ import annotations

import logging
from pathlib import Path

from hil.core.errors import BadInputError
from hil.core.files import refuse_unless_regular
from hil.core.recording._checked import checked
from hil.core.recording._column_map import AS_NAMED, ColumnMap, column_map
from hil.core.recording._envelope import Envelope, EnvelopeBuilder, Stretch
from hil.core.recording._envelope_file import Overview, overview_of, read_overview, write_overview
from hil.core.recording._evidence import (
    ACCEPTED_EXPIRY,
    DEVICE,
    REPLAY,
    RUN,
    SEGMENT,
    SOURCE,
    VEHICLE,
    run_of,
    sidecar,
)
from hil.core.recording._foreign_table import assigned_signals, columns_of
from hil.core.recording._formats import FRAME_LOGS, NOT_READ, READ, WRITTEN, reader_of, writer_of
from hil.core.recording._mcap_following import FollowedRecording
from hil.core.recording._mcap_reader import read_frames
from hil.core.recording._mcap_reader import read_mcap as read_as_written
from hil.core.recording._mcap_writer import CHUNK_BYTES, RecordingWriter
from hil.core.recording._recovery import Missing, missing_of, recover_recording
from hil.core.recording._table import BLOCK, Event, Recording, with_wheel_angle

logger = logging.getLogger(__name__)


def read_recording(
    path: Path,
    *,
    least_samples: int = 2,
    allow_missing: bool = False,
    any_replay: bool = False,
    columns: ColumnMap = AS_NAMED,
) -> Recording:
    """Read a file of an ending in `READ`; refuse what no command could use.

    Args:
        columns: which columns of another tool's file are which channels.
        allow_missing: keep channels of which much is missing, for reports of runs that failed.
        any_replay: also one decoded from a log of another bench, which has none of the axle's channels.

    Raises:
        BadInputError: names file, line and column where it can.
    """
    recording = reader_of(path)(path, columns)
    foreign = any_replay and REPLAY in recording.metadata
    recording = checked(
        recording, least_samples=least_samples, allow_missing=allow_missing, any_channels=foreign
    )
    logger.info("read %s: %d samples, %d channels", path, recording.samples, len(recording.channels))
    for sentence in (*recording.damage, *recording.notes):
        logger.debug("%s: %s", path, sentence)
    return recording


def driven_by_torque(recording: Recording) -> list[Recording]:
    """The stretches of a run in which the motor torque alone drives the axle.

    In a run of the project's own these are the segments during which the dynos simulate the vehicle; in
    between they turn the wheels themselves. Any other recording is one stretch. A stretch's `source`
    names its segment.
    """
    run = run_of(recording)
    if run is None:
        return [recording]
    driven = [segment for segment in run.segments if segment.load == "vehicle"]
    parts = with_wheel_angle(recording, [(segment.start_s, segment.end_s) for segment in driven])
    for segment, part in zip(driven, parts, strict=True):
        part.source = recording.source.with_name(f"{recording.source.stem} {segment.id}")
    if not parts:
        raise BadInputError(
            "has no segment during which the dynos simulate the vehicle",
            where=str(recording.source),
            fix="run a plan with steps or chirps of 'load: vehicle'",
        )
    return parts


def write_frames(recording: Recording, path: Path) -> int:
    """Write the raw frames of a recording as `.blf`, `.asc`, `.log` (candump) or `.mf4`; how many there are.

    Raises:
        BadInputError: the recording is no MCAP file or has no frames, or `path` cannot be written.
        BenchError: the disk is full.
    """
    from hil.core.recording._frame_log_writer import write_frame_log

    frames = read_frames(recording.source) if recording.source.suffix.lower() == ".mcap" else {}
    write_frame_log(frames, recording, path)
    return sum(len(block) for block in frames.values())


def written_with(path: Path) -> list[Path]:
    """The files that `write_recording` makes for a path: beside a CSV stands what it is a recording of."""
    return [path, sidecar(path)] if path.suffix.lower() == ".csv" else [path]


def write_recording(recording: Recording, path: Path) -> None:
    """Write `.csv`, `.parquet`, `.mf4` or `.mat`, whole or not at all, with what stands beside it."""
    writer = writer_of(path.suffix.lower())
    if writer is None:
        raise BadInputError(
            f"an export ends in {', '.join(WRITTEN)}",
            where=str(path),
            fix=f"for raw frames in {', '.join(FRAME_LOGS)}",
        )
    writer(recording, path)
    logger.info("wrote %s: %d samples, %d channels", path, recording.samples, len(recording.channels))


__all__ = [
    "ACCEPTED_EXPIRY",
    "AS_NAMED",
    "BLOCK",
    "CHUNK_BYTES",
    "DEVICE",
    "FRAME_LOGS",
    "NOT_READ",
    "READ",
    "REPLAY",
    "RUN",
    "SEGMENT",
    "SOURCE",
    "VEHICLE",
    "WRITTEN",
    "ColumnMap",
    "Envelope",
    "EnvelopeBuilder",
    "Event",
    "FollowedRecording",
    "Missing",
    "Overview",
    "Recording",
    "RecordingWriter",
    "Stretch",
    "assigned_signals",
    "checked",
    "column_map",
    "columns_of",
    "driven_by_torque",
    "missing_of",
    "overview_of",
    "read_as_written",
    "read_frames",
    "read_overview",
    "read_recording",
    "recover_recording",
    "refuse_unless_regular",
    "run_of",
    "write_frames",
    "write_overview",
    "write_recording",
    "written_with",
]
