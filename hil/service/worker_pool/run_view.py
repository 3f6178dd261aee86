"""A run as a view shows it: traces of any stretch, spectra, samples; from envelope or file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from hil.core.channels import COMFORT_BAND_HZ, unit_of
from hil.core.errors import BadInputError
from hil.core.files import is_file
from hil.core.recording import SEGMENT, Overview, Stretch
from hil.core.result import Segment
from hil.service.worker_pool.drawn_numbers import number, numbers
from test_plans.metrics import energy_within, periodogram

Array = npt.NDArray[np.float64]

#: Samples that are read at once for a closer look or a spectrum; more is too far away to need them.
MOST_ROWS = 1_000_000
_HIGHEST_HZ = 100.0


def shown(overview: Overview) -> dict[str, Any]:
    """What `RunViewData` has of the recording itself."""
    envelope, tables = overview.envelope, overview.tables
    units = tables.get("units", {})
    return {
        "first_s": envelope.first_s,
        "last_s": envelope.last_s,
        "sample_time_s": number(envelope.sample_time_s),
        "channels": {name: units.get(name) or unit_of(name) for name in envelope.names},
        "marks": marks_of(tables, overview),
        "facts": {
            f"{table} {name}" if table == "dut" else name: value
            for table in ("run", "dut")
            for name, value in tables.get(table, {}).items()
        },
    }


def marks_of(tables: Mapping[str, Mapping[str, str]], overview: Overview | None) -> list[dict[str, Any]]:
    """Segments as far as they are recorded, and events."""
    found: list[dict[str, Any]] = []
    for name, table in tables.items():
        if name.startswith(SEGMENT):
            one = Segment.model_validate_json(table["json"])
            over = one.end_s if one.end_s > one.start_s else None
            found.append(
                {"kind": "segment", "name": one.id, "text": one.controller or one.kind}
                | {"start_s": one.start_s, "step_s": one.step_s, "end_s": over}
            )
    for event in overview.events if overview else ():
        found.append({"kind": "event", "name": event.kind, "text": event.text, "start_s": event.time_s})
    return found


def traces_of(
    overview: Overview, recording: Path, channels: list[str], start_s: float, end_s: float, most: int
) -> dict[str, Any]:
    """Buckets of the envelope; of samples where those are closer than its buckets are wide.

    Raises:
        BadInputError: the run has no such channel, or the recording was changed.
    """
    envelope = overview.envelope
    _refuse_unknown(overview, channels)
    start_s, end_s = max(start_s, envelope.first_s), min(end_s, envelope.last_s)
    wanted_s = (end_s - start_s) / most
    exact, near = False, envelope.samples_between(start_s, end_s)
    if wanted_s < 0.5 * envelope.width_s and 0 < near <= MOST_ROWS and is_file(recording):
        rows = envelope.rows(overview.reader(recording), start_s - 1e-9, end_s + 1e-9)
        exact = len(rows) <= most
        width_s = envelope.sample_time_s if exact else max(wanted_s, envelope.sample_time_s)
        found = _bucketed(envelope.names, rows, channels, start_s, width_s)
    else:
        found = envelope.stretch(channels, start_s, end_s, most)
    return {
        "start_s": found.start_s,
        "width_s": found.width_s,
        "exact": exact,
        "channels": {
            name: {"lowest": numbers(found.lowest[name]), "highest": numbers(found.highest[name])}
            for name in channels
        },
    }


def spectrum_of(
    overview: Overview, recording: Path, channel: str, start_s: float, end_s: float
) -> dict[str, Any]:
    """Power spectral density of the samples between two times.

    Raises:
        BadInputError: like `traces_of`, or the stretch has too few samples, or too many.
    """
    time, values = _samples(overview, recording, [channel], start_s, end_s)
    spacing_s = overview.envelope.sample_time_s
    there = values[0][np.isfinite(values[0])]
    if len(there) < 64:
        raise BadInputError(
            "a spectrum needs 64 samples at least", where=channel, fix="show a longer stretch"
        )
    hz, density = periodogram(there, spacing_s)
    seen = hz <= _HIGHEST_HZ
    return {
        "channel": channel,
        "start_s": float(time[0]),
        "end_s": float(time[-1]),
        "step_hz": float(hz[1]),
        "density": numbers(density[seen]),
        "band_energy": energy_within(hz, density, *COMFORT_BAND_HZ),
    }


def samples_of(
    overview: Overview, recording: Path, channels: list[str], start_s: float, end_s: float, most: int
) -> dict[str, Any]:
    """Samples at the same moments, every n-th if there are more than `most`.

    Raises:
        BadInputError: like `spectrum_of`.
    """
    time, values = _samples(overview, recording, channels, start_s, end_s)
    every = max(1, -(-len(time) // most))
    return {
        "every": every,
        "time_s": numbers(time[::every]),
        "channels": {name: numbers(column[::every]) for name, column in zip(channels, values, strict=True)},
    }


def _samples(
    overview: Overview, recording: Path, channels: list[str], start_s: float, end_s: float
) -> tuple[Array, list[Array]]:
    envelope = overview.envelope
    _refuse_unknown(overview, channels)
    if not envelope.parts or not is_file(recording):
        raise BadInputError(
            "its samples cannot be read one by one", fix="hil evidence recover, or bring it back"
        )
    if envelope.samples_between(start_s, end_s) > MOST_ROWS:
        raise BadInputError(f"more than {MOST_ROWS:,} samples lie there", fix="show a shorter stretch")
    rows = envelope.rows(overview.reader(recording), start_s, end_s)
    if not len(rows):
        raise BadInputError("no data were measured in this period")
    columns = [1 + envelope.names.index(name) for name in channels]
    return rows[:, 0], [rows[:, column] for column in columns]


def _bucketed(
    names: tuple[str, ...], rows: Array, channels: list[str], start_s: float, width_s: float
) -> Stretch:
    """Lowest and highest in buckets, of one sample each where they are as wide as samples are apart."""
    offset = rows[0, 0] if len(rows) else start_s
    places = np.rint((rows[:, 0] - offset) / width_s).astype(np.int64) if len(rows) else np.zeros(0, np.int64)
    count = int(places[-1]) + 1 if len(places) else 0
    starts = np.flatnonzero(np.diff(places, prepend=-1))
    low, high = {}, {}
    for name in channels:
        column = rows[:, 1 + names.index(name)]
        low[name], high[name] = np.full(count, np.nan), np.full(count, np.nan)
        if count:
            low[name][places[starts]] = np.fmin.reduceat(column, starts)
            high[name][places[starts]] = np.fmax.reduceat(column, starts)
    return Stretch(float(offset) - 0.5 * width_s, width_s, low, high)


def _refuse_unknown(overview: Overview, channels: list[str]) -> None:
    for name in channels:
        if name not in overview.envelope.names:
            raise BadInputError(
                f"has no channel '{name}'", fix=f"it has: {', '.join(overview.envelope.names)}"
            )
