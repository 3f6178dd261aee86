"""LabVIEW's TDMS with nptdms: channels in groups, with a column of time or the time of a waveform."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Any

import numpy as np

from hil.core.errors import BadInputError
from hil.core.errors.extras import need
from hil.core.files import refuse_unless_regular
from hil.core.recording._column_map import AS_NAMED, ColumnMap
from hil.core.recording._foreign_table import Column, recording_of
from hil.core.recording._table import Array, Recording, refuse_too_large

_UNITS = ("unit_string", "NI_UnitDescription", "unit", "Unit")


def read_tdms(path: Path, columns: ColumnMap = AS_NAMED) -> Recording:
    """Read a TDMS file; where it has several groups, a channel is named `group/channel`.

    Raises:
        BadInputError: nptdms is not installed, no TDMS file or a broken one, or what `recording_of` refuses.
    """
    refuse_unless_regular(path)
    need("nptdms", "export it from LabVIEW or DIAdem as text")
    from nptdms import TdmsFile

    notes: list[str] = []
    try:
        logging.getLogger("nptdms").setLevel(logging.CRITICAL + 1)  # what matters of a file is stated here
        with path.open("rb") as opened, TdmsFile.open(opened) as file:
            channels = [channel for group in file.groups() for channel in group.channels()]
            refuse_too_large(max(map(len, channels), default=0), len(channels), str(path))
            if sum(map(len, channels)) > path.stat().st_size:
                raise ValueError("promises more values than it has bytes")
            if file.file_status.incomplete_final_segment:
                notes.append("is cut off: what is whole was read")
            several = sum(bool(group.channels()) for group in file.groups()) > 1
            table = {}
            for channel in channels:
                name = f"{channel.group_name}/{channel.name}" if several else channel.name
                column = _column(channel)
                if column is None:
                    notes.append(f"channel '{name}' is not numeric and was left out")
                else:
                    table[name] = column
    except BadInputError:
        raise
    except Exception as error:  # of many kinds, for whatever is broken
        raise BadInputError("not a TDMS file, or a broken one", where=str(path)) from error
    return recording_of(table, path, columns, "channel", notes)


def _column(channel: Any) -> Column | None:
    values = np.asarray(channel[:])
    if values.dtype.kind == "M":
        since = (values - values[:1]) / np.timedelta64(1, "us") if len(values) else values.astype(np.float64)
        return Column(np.asarray(since, np.float64) / 1e6, "s")
    if values.ndim != 1 or values.dtype.kind not in "fiub":
        return None
    unit = str(next((channel.properties[key] for key in _UNITS if key in channel.properties), ""))
    return Column(values.astype(np.float64), unit, _time_s(channel, len(values)))


def _time_s(channel: Any, samples: int) -> Array | None:
    """Stamps of a waveform from its begin and distance; None of a channel that is no waveform."""
    distance_s = float(channel.properties.get("wf_increment", 0.0))
    if not distance_s > 0.0:
        return None
    offset_s = float(channel.properties.get("wf_start_offset", 0.0))
    return np.asarray(offset_s + distance_s * np.arange(samples))
