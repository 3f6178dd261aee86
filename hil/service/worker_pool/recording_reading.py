"""What a recording that somebody gives says: read in another process by the readers of the commands."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from hil.api_schemas.recording import MOST_SHOWN_CHANNELS
from hil.core.channels import unit_of
from hil.core.errors import BadInputError
from hil.core.recording import Recording, column_map, read_recording, run_of, write_recording

_MOST_NOTES = 50


def recording(path: str, columns: list[str]) -> dict[str, Any]:
    """Fields of `RecordingData` for a file; what columns name is written beside it under channels' names.

    Raises:
        BadInputError: it is no recording, or needs too much memory.
    """
    source = Path(path)
    try:
        found = read_recording(source, allow_missing=True, any_replay=True, columns=column_map(columns))
        run = run_of(found)
        used = _with_channels(found, source) if columns else source.name
    except MemoryError:
        raise BadInputError(
            "needs more memory to be read than the service grants", where=path, fix="cut it into pieces"
        ) from None
    units = found.metadata.get("units", {})
    names = list(found.channels)[:MOST_SHOWN_CHANNELS]
    notes = [*found.damage, *found.notes]
    left = len(notes) - _MOST_NOTES
    return {
        "samples": found.samples,
        "duration_s": found.last_s - found.first_s,
        "channel_count": len(found.channels),
        "channels": [{"name": name, "unit": units.get(name) or unit_of(name)} for name in names],
        "plan": run.plan if run is not None else "",
        "notes": notes if left <= 0 else [*notes[:_MOST_NOTES], f"and {left} more"],
        "used": used,
    }


def _with_channels(found: Recording, source: Path) -> str:
    """The recording under its channels' names: studies take several, each with other columns."""
    place = source.with_name(f"{source.stem}.channels.parquet")
    write_recording(found, place)
    return place.name
