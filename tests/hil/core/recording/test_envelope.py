"""Envelopes: no peak is lost however samples come; samples are found where they lie."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil.core.errors import BadInputError
from hil.core.recording import (
    EnvelopeBuilder,
    RecordingWriter,
    _envelope,
    overview_of,
    read_overview,
    write_overview,
)

NAMES = ["time_s", "motor_speed_rad_s", "shaft_torque_nm"]


def samples(count: int, *, spacing_s: float = 1e-3, first_s: float = 0.0) -> np.ndarray:
    noise = np.random.default_rng(count).normal(size=(count, 2))
    return np.column_stack([first_s + spacing_s * np.arange(count), noise])


def filled(rows: np.ndarray, parts: list[int]) -> EnvelopeBuilder:
    builder, start = EnvelopeBuilder(NAMES[1:]), 0
    for part in parts:
        builder.add(start, rows[start : start + part])
        start += part
    return builder


@given(
    st.lists(st.integers(1, 900), min_size=1, max_size=8),
    st.floats(-2.0, 9.0),
    st.floats(0.001, 20.0),
    st.integers(10, 300),
)
def test_every_sample_of_a_stretch_lies_within_its_bucket(
    parts: list[int], start_s: float, length_s: float, most: int
) -> None:
    rows = samples(sum(parts))
    envelope = filled(rows, parts).envelope()
    found = envelope.stretch(NAMES[1:], start_s, start_s + length_s, most)
    low, high = found.lowest["shaft_torque_nm"], found.highest["shaft_torque_nm"]
    assert len(low) <= most
    place = np.floor((rows[:, 0] - found.start_s) / found.width_s + 1e-6).astype(int)
    asked = (rows[:, 0] >= start_s) & (rows[:, 0] < start_s + length_s)
    assert ((place[asked] >= 0) & (place[asked] < len(low))).all()
    for bucket in range(len(low)):
        inside = rows[place == bucket, 2].astype(np.float32)
        if len(inside):
            assert (low[bucket], high[bucket]) == (inside.min(), inside.max())
        else:
            assert np.isnan(low[bucket])


def test_a_long_run_has_wider_buckets_and_still_every_peak(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_envelope, "MOST_BUCKETS", 64)
    rows = samples(40_000, first_s=0.5)
    rows[23_456, 2] = 1e4
    envelope = filled(rows, [999] * 40 + [40]).envelope()
    assert envelope.lowest.shape[1] <= 64
    assert envelope.width_s > 20 * _envelope.FINEST_S
    at = int(np.nanargmax(envelope.highest[1]))
    assert (
        (envelope.first + at) * envelope.width_s
        <= rows[23_456, 0]
        < (envelope.first + at + 1) * envelope.width_s
    )
    assert np.nanmin(envelope.lowest[0]) == rows[:, 1].astype(np.float32).min()


def test_time_in_which_nothing_came_is_empty() -> None:
    rows = np.vstack([samples(100), samples(100, first_s=5.0)])
    found = filled(rows, [100, 100]).envelope().stretch(NAMES[1:2], 0.0, 6.0, 1000)
    low = found.lowest["motor_speed_rad_s"]
    assert np.isnan(low[10:240]).all()
    assert np.isfinite(low[:5]).all()


def test_values_that_are_not_known_do_not_hide_those_beside_them() -> None:
    rows = samples(40)
    rows[3:30, 1] = np.nan
    envelope = filled(rows, [40]).envelope()
    assert np.isfinite(envelope.lowest[0]).all()


def test_a_channel_that_is_not_there_is_named() -> None:
    with pytest.raises(KeyError, match="nothing"):
        filled(samples(10), [10]).envelope().stretch(["nothing"], 0.0, 1.0, 10)


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    writer = RecordingWriter(tmp_path / "recording.mcap", NAMES, ["rmcu"], chunk_bytes=20_000)
    writer.add_rows(samples(5000))
    writer.add_event(1.0, "segment", "begins")
    writer.close()
    return tmp_path / "recording.mcap"


def test_what_was_kept_is_found_again(recording: Path, tmp_path: Path) -> None:
    made = overview_of(recording)
    assert read_overview(tmp_path / "kept") is None
    write_overview(made, tmp_path / "kept")
    found = read_overview(tmp_path / "kept")
    assert np.array_equal(found.envelope.lowest, made.envelope.lowest, equal_nan=True)
    assert (found.envelope.parts, found.row_ids) == (made.envelope.parts, made.row_ids)
    assert [event.text for event in found.events] == ["begins"]


def test_half_of_what_was_kept_is_nothing(recording: Path, tmp_path: Path) -> None:
    write_overview(overview_of(recording), tmp_path / "kept")
    (tmp_path / "kept/buckets.npy").write_bytes(b"")
    assert read_overview(tmp_path / "kept") is None


@pytest.mark.parametrize("start_s", [-1.0, 0.0, 0.4995, 1.25, 4.9, 6.0])
@pytest.mark.parametrize("length_s", [0.0, 0.0101, 0.7, 9.0])
def test_samples_are_read_where_they_lie(recording: Path, start_s: float, length_s: float) -> None:
    overview, rows = overview_of(recording), samples(5000)
    assert len(overview.envelope.parts) > 3
    found = overview.envelope.rows(overview.reader(recording), start_s, start_s + length_s)
    inside = (rows[:, 0] >= start_s) & (rows[:, 0] <= start_s + length_s)
    assert np.array_equal(found, rows[inside])


def test_a_recording_that_was_cut_off_still_shows_what_is_left(recording: Path) -> None:
    content = recording.read_bytes()
    recording.write_bytes(content[: len(content) // 2])
    overview = overview_of(recording)
    assert 0.0 < overview.envelope.last_s < 4.9
    assert overview.envelope.parts == []


def test_what_is_no_recording_is_refused(tmp_path: Path) -> None:
    (tmp_path / "recording.mcap").write_bytes(b"nothing")
    with pytest.raises(BadInputError):
        overview_of(tmp_path / "recording.mcap")
