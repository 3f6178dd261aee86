"""Noise that the bench file of a recording states for its sensors."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hil.core.channels import OUTPUTS
from hil.core.errors import BadInputError
from hil.core.files.toml_file import parse_toml
from hil.core.recording import Recording

_BENCH_FILE, _TABLE = "bench.toml", "noise"


def stated_noise(recordings: Sequence[Recording]) -> dict[str, float]:
    """Standard deviation of a sample by channel, the largest that the recordings' bench files state.

    A recording without its bench file, or with one that is none, states nothing.
    """
    found: dict[str, float] = {}
    for recording in recordings:
        for channel, value in _table(recording).items():
            if not isinstance(value, int | float) or isinstance(value, bool):
                continue
            if channel in OUTPUTS and np.isfinite(value) and value >= 0.0:
                found[channel] = max(found.get(channel, 0.0), float(value))
    return found


def _table(recording: Recording) -> dict[str, object]:
    try:
        bench = parse_toml(recording.attachments.get(_BENCH_FILE, b"").decode(), _BENCH_FILE)
    except (UnicodeDecodeError, BadInputError):
        return {}
    table = bench.get(_TABLE)
    return table if isinstance(table, dict) else {}
