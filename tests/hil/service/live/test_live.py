"""What is live: no peak is lost, whatever comes at once and however late a viewer asks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from hil.core.recording import FollowedRecording, RecordingWriter, read_as_written
from hil.service.live.live import BUCKET_S, MOST_BUCKETS, SPECTRUM_CHANNEL, Buckets, LiveRun
from test_plans import plan_from_text
from tests.hil.service.served import SHORT

NAMES = ["time_s", SPECTRUM_CHANNEL, "shaft_torque_nm"]


def samples(count: int, *, seed: int = 1) -> np.ndarray:
    time = np.arange(count) * 1e-3
    noise = np.random.default_rng(seed).normal(size=(count, 2))
    return np.column_stack([time, noise[:, 0] + 3 * np.sin(2 * np.pi * 12 * time), noise[:, 1]])


@given(st.lists(st.integers(1, 900), min_size=1, max_size=12), st.data())
def test_every_peak_is_in_some_bucket(parts: list[int], data: st.DataObject) -> None:
    rows = samples(sum(parts))
    rows[data.draw(st.integers(0, len(rows) - 1)), 2] = 1e4
    buckets, start, next_, low, high = Buckets(), 0, 0, [], []
    for part in parts:
        buckets.add(NAMES, rows[start : start + part])
        start += part
        buckets.show(1e3)
        if data.draw(st.booleans()) and (stretch := buckets.since(next_)) is not None:
            assert stretch.start_s == next_ * BUCKET_S
            next_ = buckets.shown
            low.append(stretch.lowest)
            high.append(stretch.highest)
    buckets.add(NAMES, np.array([[rows[-1, 0] + BUCKET_S, 0.0, 0.0]]))
    buckets.show(1e3)
    low.append(buckets.since(next_).lowest)
    high.append(buckets.since(next_).highest)
    full = rows[:, 0] < buckets.next * BUCKET_S - 1e-9
    assert np.array_equal(np.min(np.concatenate(low), axis=0), rows[full, 1:].min(axis=0))
    assert np.array_equal(np.max(np.concatenate(high), axis=0), rows[full, 1:].max(axis=0))


def test_a_late_viewer_gets_wider_buckets_and_still_every_peak() -> None:
    rows = samples(30_000)
    rows[12_345, 2] = -500.0
    buckets = Buckets()
    buckets.add(NAMES, rows)
    buckets.show(1e3)
    stretch = buckets.since(0)
    assert len(stretch.lowest) <= MOST_BUCKETS
    assert stretch.lowest[:, 1].min() == -500.0
    at = int(stretch.lowest[:, 1].argmin())
    assert stretch.start_s + at * stretch.width_s <= 12.345 < stretch.start_s + (at + 1) * stretch.width_s
    assert buckets.since(buckets.next) is None


def test_time_in_which_nothing_came_is_empty() -> None:
    buckets = Buckets()
    buckets.add(NAMES, np.array([[0.0, 1.0, 2.0]]))
    buckets.add(NAMES, np.array([[5 * BUCKET_S, 3.0, 4.0]]))
    buckets.show(1e3)
    stretch = buckets.since(0)
    assert stretch.lowest[:, 0].tolist()[0] == 1.0
    assert np.isnan(stretch.lowest[1:, 0]).all()


def test_what_is_written_at_once_is_shown_as_it_was_measured() -> None:
    """150 ms at a time, looked at every 50 ms: an update at every look, none of it older than 0.2 s."""
    buckets, rows, updates = Buckets(), samples(6000), []
    for look in range(100):
        if look % 3 == 0:
            buckets.add(NAMES, rows[50 * look : 50 * look + 150])
        before = buckets.shown
        updates.append(buckets.show(0.05))
        assert buckets.next - buckets.shown <= 10
        assert 0 <= buckets.shown - before <= 10
        assert updates[-1] == (buckets.shown > before)
    assert sum(updates[10:]) >= 88


def test_a_recording_is_read_while_it_grows(tmp_path: Path) -> None:
    path, rows = tmp_path / "recording.mcap", samples(5000)
    writer = RecordingWriter(path, NAMES, ["rmcu"])
    found = []
    with FollowedRecording(path) as followed:
        assert followed.fetch().shape == (0, 0)
        for start in range(0, 5000, 700):
            writer.add_rows(rows[start : start + 700])
            writer.flush()
            found.append(followed.fetch())
        writer.add_event(1.0, "segment", "begins")
        writer.close()
        found.append(followed.fetch())
        assert followed.over
        assert followed.names == NAMES
        assert [event.text for event in followed.events] == ["begins"]
    together = np.concatenate([one for one in found if len(one)])
    assert np.array_equal(together, rows)
    assert np.array_equal(together[:, 1], read_as_written(path)[SPECTRUM_CHANNEL])


def test_the_last_speed_that_was_measured_stays_known_when_the_run_is_over(tmp_path: Path) -> None:
    path, rows = tmp_path / "recording.mcap", samples(300)
    rows[-2, 1], rows[-1, 1] = 137.0, np.nan
    live = LiveRun(path, plan_from_text(SHORT, "p", tmp_path))
    assert live.last_speed is None
    writer = RecordingWriter(path, NAMES, ["rmcu"])
    writer.add_rows(rows)
    writer.close()
    live.look(0.0)
    assert live.over
    live.close()
    assert live.last_speed is not None
    assert live.last_speed[0] == 137.0


@given(st.lists(st.integers(0, 3000), max_size=6).map(sorted))
def test_half_a_record_is_taken_when_it_is_whole(cuts: list[int]) -> None:
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        whole, growing = Path(folder) / "whole.mcap", Path(folder) / "growing.mcap"
        rows = samples(300)
        writer = RecordingWriter(whole, NAMES, ["rmcu"], chunk_bytes=2000)
        writer.add_rows(rows)
        writer.close()
        content = whole.read_bytes()
        growing.write_bytes(b"")
        with FollowedRecording(growing) as followed:
            found = []
            for start, end in zip([0, *cuts], [*cuts, len(content)], strict=True):
                with growing.open("ab") as file:
                    file.write(content[start:end])
                found.append(followed.fetch())
        assert np.array_equal(np.concatenate([one for one in found if len(one)]), rows)


def test_the_spectrum_says_what_lies_in_the_band(tmp_path: Path) -> None:
    path, rows = tmp_path / "recording.mcap", samples(9000)
    writer = RecordingWriter(path, NAMES, ["rmcu"])
    writer.add_rows(rows)
    writer.close()
    live = LiveRun(path, plan_from_text(SHORT, "p", tmp_path))
    assert live.spectrum() is None
    assert live.look(0.0)
    assert live.buckets.shown > live.buckets.next - 20  # it came at once, and is old
    assert abs(live.spectrum().band_energy - 4.5) < 0.2  # 3²/2, and some noise
    live.close()
