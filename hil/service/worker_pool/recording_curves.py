"""Curves of recordings that people gave, and of models that are driven by their torque, as envelopes."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Any

import numpy as np

from hil.core.channels import OUTPUTS, TIME, unit_of
from hil.core.errors import BadInputError
from hil.core.model import load_model
from hil.core.recording import Recording, read_recording
from hil.plant import replay
from hil.service.worker_pool.drawn_numbers import envelope, number, numbers

_KEPT = 3  # recordings that stay read, and simulations that stay computed
#: A simulation is held whole beside its recording.
_MOST_SIMULATED = 20_000_000


def measured(
    path: str, channels: list[str], start_s: float | None, end_s: float | None, most: int
) -> dict[str, Any]:
    """Fields of `RecordingCurves` of some channels.

    Raises:
        BadInputError: the recording has no such channel, or nothing in this period.
    """
    return {**_curves(_read(path), channels, start_s, end_s, most), "notes": []}


def simulated(path: str, model: str, start_s: float | None, end_s: float | None, most: int) -> dict[str, Any]:
    """Fields of `RecordingCurves` of a model's outputs that the recording has, with their gaps.

    Raises:
        BadInputError: the simulation diverges, or the recording is too long or lacks what the model needs.
    """
    recording, found = _read(path), _simulated(path, model)
    channels = [name for name in OUTPUTS if name in found and name in recording]
    curves = _curves(found, channels, start_s, end_s, most)
    for curve in curves["curves"]:
        name = curve["channel"]
        curve["gap"] = _gap(recording[name], found[name])
    return {**curves, "notes": list(found.notes)}


@functools.lru_cache(_KEPT)
def _read(path: str) -> Recording:
    return read_recording(Path(path), allow_missing=True, any_replay=True)


@functools.lru_cache(_KEPT)
def _simulated(path: str, model: str) -> Recording:
    recording = _read(path)
    if recording.samples > _MOST_SIMULATED:
        raise BadInputError(
            f"has {recording.samples} samples, at most {_MOST_SIMULATED} are simulated here",
            where=recording.source.name,
            fix="cut it into pieces, or use hil simulate",
        )
    return replay(load_model(Path(model)), recording)


def _curves(
    recording: Recording, channels: list[str], start_s: float | None, end_s: float | None, most: int
) -> dict[str, Any]:
    for name in channels:
        if name not in recording:
            raise BadInputError(f"has no channel '{name}'", where=recording.source.name)
    first_s = max(recording.first_s, recording.first_s if start_s is None else start_s)
    last_s = min(recording.last_s, recording.last_s if end_s is None else end_s)
    if not first_s < last_s:
        raise BadInputError("no data were measured in this period", where=recording.source.name)
    part = recording.between(first_s, last_s)
    width_s = max((last_s - first_s) / most, recording.sample_time_s)
    count = int(np.ceil((last_s - first_s) / width_s * (1 - 1e-9)))
    found = []
    for name in channels:
        lowest, highest = envelope(part[TIME], part[name], first_s, width_s, count)
        unit = recording.metadata.get("units", {}).get(name) or unit_of(name)
        found.append({"channel": name, "unit": unit, "lowest": numbers(lowest), "highest": numbers(highest)})
    return {"start_s": first_s, "width_s": width_s, "curves": found}


def _gap(of_recording: Any, of_model: Any) -> float | None:
    """Rms of the difference over the recording's rms around its mean."""
    there = np.isfinite(of_recording) & np.isfinite(of_model)
    if not np.any(there):
        return None
    size, difference = float(np.std(of_recording[there])), of_model[there] - of_recording[there]
    return number(float(np.sqrt(np.mean(difference**2))) / size) if size else None
