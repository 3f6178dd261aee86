"""An MCAP file whose channels have the names of another tool, as of a log that was decoded by its DBC."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from hil.core.channels import CHANNELS
from hil.core.errors import BadInputError
from hil.core.recording._column_map import AS_NAMED, ColumnMap
from hil.core.recording._foreign_table import Column, recording_of
from hil.core.recording._mcap_reader import read_mcap
from hil.core.recording._run import RUN
from hil.core.recording._table import Recording

#: Metadata table with units by channel, of a log that was decoded by its DBC.
_UNITS = "units"


def read_mapped_mcap(path: Path, columns: ColumnMap = AS_NAMED) -> Recording:
    """A recording; with a map of columns its channels are assigned, and all are held.

    Raises:
        BadInputError: what `read_mcap` and `recording_of` refuse, or a map for a run of this software.
    """
    recording = read_mcap(path)
    if not columns:
        return recording
    if RUN in recording.attachments:
        raise BadInputError(
            "is a run of this software, whose channels are known", where=str(path), fix="leave out --columns"
        )
    wanted = {source.column.lower() for _, source in columns.columns()}
    kept = [name for name in recording.channels if name in CHANNELS or _may_be(name, wanted)]
    units = recording.metadata.get(_UNITS, {})
    table = {name: Column(recording[name], units.get(name, "")) for name in kept or recording.channels}
    found = recording_of(table, path, columns, "channel", list(recording.notes))
    return replace(
        recording,
        channels=found.channels,
        notes=found.notes,
        metadata={**recording.metadata, **found.metadata},
    )


def _may_be(name: str, wanted: set[str]) -> bool:
    return any(column in name.lower() or name.lower() in column for column in wanted)
