"""The envelope of a recording in a folder of its own: made once, then opened at once."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from hil.core.channels import TIME
from hil.core.errors import BadInputError
from hil.core.files import replacing
from hil.core.recording._envelope import Envelope, EnvelopeBuilder, RowPart
from hil.core.recording._mcap_following import FollowedRecording
from hil.core.recording._stored import RowReader
from hil.core.recording._table import Event, Recording

_BUCKETS, _FACTS = "buckets.npy", "envelope.json"
_FORMAT = 1
_AT_ONCE_BYTES = 1 << 24


@dataclass(frozen=True)
class Overview:
    """An envelope with what else of its recording a view shows.

    Attributes:
        tables: metadata of the recording by name, such as `segment/<id>`.
        row_ids: the file's numbers of the channels whose messages are rows.
    """

    envelope: Envelope
    tables: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    events: tuple[Event, ...] = ()
    row_ids: frozenset[int] = frozenset()

    def reader(self, recording: Path) -> RowReader:
        """Reads rows of the recording where it lies now."""
        return RowReader(recording, [TIME, *self.envelope.names], self.row_ids)


def overview_of(path: Path) -> Overview:
    """Go through an MCAP recording once; what is broken of it is left out.

    Raises:
        BadInputError: not a recording of the project, or no sample in it.
    """
    try:
        found = _followed(path)
    except BadInputError:
        found = None
    overview = found or _read(path)
    if overview is None:
        raise BadInputError("has no samples", where=str(path))
    return overview


def write_overview(overview: Overview, folder: Path) -> None:
    """Put it into a folder, whole or not at all: the facts come last, and without them there is nothing.

    Raises:
        OSError: the disk is full, or the folder may not be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    (folder / _FACTS).unlink(missing_ok=True)
    envelope = overview.envelope
    with replacing(folder / _BUCKETS) as temporary, temporary.open("wb") as file:
        np.save(file, np.stack([envelope.lowest, envelope.highest]))
    facts = {
        "format": _FORMAT,
        "names": envelope.names,
        "width_s": envelope.width_s,
        "first": envelope.first,
        "first_s": envelope.first_s,
        "last_s": envelope.last_s,
        "sample_time_s": None if math.isnan(envelope.sample_time_s) else envelope.sample_time_s,
        "parts": [[part.position, part.count, part.first_s, part.last_s] for part in envelope.parts],
        "row_ids": sorted(overview.row_ids),
        "tables": overview.tables,
        "events": [[event.time_s, event.kind, event.text] for event in overview.events],
    }
    with replacing(folder / _FACTS) as temporary:
        temporary.write_text(json.dumps(facts), "utf-8")


def read_overview(folder: Path) -> Overview | None:
    """What was put there; None if nothing was, or by another version. The buckets stay in their file."""
    try:
        facts: dict[str, Any] = json.loads((folder / _FACTS).read_text("utf-8"))
        buckets = np.load(folder / _BUCKETS, mmap_mode="r")
        if facts["format"] != _FORMAT:
            return None
        spacing = facts["sample_time_s"]
        envelope = Envelope(
            tuple(facts["names"]),
            facts["width_s"],
            facts["first"],
            buckets[0],
            buckets[1],
            [RowPart(*part) for part in facts["parts"]],
            facts["first_s"],
            facts["last_s"],
            math.nan if spacing is None else spacing,
        )
        events = tuple(Event(*event) for event in facts["events"])
        return Overview(envelope, facts["tables"], events, frozenset(facts["row_ids"]))
    except (OSError, EOFError, ValueError, KeyError, TypeError, IndexError):
        return None


def _followed(path: Path) -> Overview | None:
    builder: EnvelopeBuilder | None = None
    with FollowedRecording(path) as file:
        while parts := file.fetch_parts(_AT_ONCE_BYTES):
            builder = builder or EnvelopeBuilder(file.names[1:])
            for position, rows in parts:
                builder.add(position, rows)
        if not file.over:
            return None  # cut off or broken: the reader that mends says what is left
        envelope = builder.envelope() if builder else None
        if envelope is None:
            return None
        return Overview(envelope, file.tables, tuple(file.events), file.row_ids)


def _read(path: Path) -> Overview | None:
    """Of what can be read; samples are not found again one by one."""
    from hil.core.recording._mcap_reader import read_mcap

    recording: Recording = read_mcap(path)
    names = [name for name in recording.channels if name != TIME]
    builder = EnvelopeBuilder(names)
    for _, rows in recording.blocks():
        builder.add(0, np.column_stack([rows[TIME], *(rows[name] for name in names)]))
    envelope = builder.envelope()
    if envelope is None:
        return None
    found = Envelope(**{**vars(envelope), "parts": []})
    return Overview(found, recording.metadata, tuple(recording.events))
