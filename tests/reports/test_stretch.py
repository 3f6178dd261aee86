"""What of a channel is drawn as one line."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from hil.core.recording import Recording
from reports.labels import Label
from reports.stretch import line


def drawn(values: np.ndarray) -> np.ndarray:
    recording = Recording({"time_s": np.arange(float(len(values))), "own": values}, Path("r.mcap"))
    trace = line(recording, "own", Label("own"), "gain", start_s=0.0, end_s=float(len(values)))
    assert trace is not None
    return np.asarray(trace.y)


def test_a_slow_device_is_a_line_through_its_samples() -> None:
    values = np.full(40, np.nan)
    values[::4] = np.arange(10.0)
    assert drawn(values).tolist() == np.arange(10.0).tolist()


def test_what_is_missing_of_a_fast_one_is_a_gap() -> None:
    values = np.arange(40.0)
    values[10:20] = np.nan
    found = drawn(values)
    assert np.isnan(found).any()
    assert np.isfinite(found).sum() == 30
