"""From samples and events of a bench to a recording."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from drivers import Counting, Samples, Stream
from hil.core.recording import read_recording
from hil.engine.run.recorder import Recorder

CHANNELS = ("motor_torque_ref_nm", "motor_speed_rad_s")
BASE = Stream("frame 0x110", "bus 'rmcu'", CHANNELS, ("N m", "rad/s"), 0.001)
SLOW = Stream("readings", "device 'oil'", ("oil_temperature_k",), ("K",), 0.1)


def samples(stream: Stream, *times_s: float, value: float = 1.0) -> Samples:
    return Samples(stream, np.array(times_s), np.full((len(times_s), len(stream.channels)), value))


@pytest.fixture
def recorder(tmp_path: Path) -> Iterator[Recorder]:
    one = Recorder(tmp_path / "r.mcap", [BASE, SLOW], ["rmcu"], 0.001)
    yield one
    one.writer.close()


def test_nothing_is_kept_before_it_begins_and_times_count_from_the_first_sample(recorder: Recorder) -> None:
    recorder.take(samples(BASE, 4.9))
    assert recorder.start_s is None
    assert recorder.recording_time(5.0) == 0.0
    recorder.begin()
    recorder.take(samples(SLOW, 4.95))  # not the time base
    assert recorder.start_s is None
    recorder.take(samples(BASE, *(5.0 + 0.001 * np.arange(400))))
    assert recorder.start_s == 5.0
    assert recorder.recording_time(5.2504) == 0.25
    assert recorder.recording_time(4.0) == 0.0  # before the recording


def test_rows_are_written_every_half_second_and_the_rest_at_the_end(
    tmp_path: Path,
) -> None:
    recorder = Recorder(tmp_path / "r.mcap", [BASE, SLOW], ["rmcu"], 0.001)
    recorder.begin()
    recorder.take(samples(SLOW, 5.0, 5.1, 5.2, 5.3, 5.4, 5.5, 5.6, 5.7, value=330.0))
    for first in range(0, 700, 10):
        recorder.take(samples(BASE, *(5.0 + 0.001 * np.arange(first, first + 10)), value=2.0))
    recorder.event(5.25, "arm", "armed")
    whole = recorder.finish_rows()
    assert recorder._chunks  # few rows need not be read from the file
    assert len(whole.time_s) == 700
    assert whole.time_s[0] == 0.0
    assert np.all(whole["motor_speed_rad_s"] == 2.0)
    assert [(e.time_s, e.kind, e.text) for e in whole.events] == [(0.25, "arm", "armed")]
    recorder.writer.close()
    read = read_recording(tmp_path / "r.mcap")
    assert np.array_equal(read.time_s, whole.time_s)
    assert np.array_equal(read["oil_temperature_k"], whole["oil_temperature_k"], equal_nan=True)


def test_others_have_their_turn_between_the_streams_while_rows_are_made(tmp_path: Path) -> None:
    turns: list[int] = []
    recorder = Recorder(tmp_path / "r.mcap", [BASE, SLOW], ["rmcu"], 0.001, between=lambda: turns.append(0))
    recorder.begin()
    for first in range(0, 400, 10):
        recorder.take(samples(BASE, *(5.0 + 0.001 * np.arange(first, first + 10))))
    assert len(turns) == 2  # the clocks were looked at, once
    recorder.take(samples(BASE, *(5.0 + 0.001 * np.arange(400, 600))))
    # Two streams numbered, one placed; the rows as a whole, and as they are written
    assert len(turns) >= 5
    made = len(turns)
    recorder.keep()
    assert len(turns) >= made + 7  # likewise; the bus's frames, the block put together, and compressed
    recorder.writer.close()


def test_what_is_kept_promptly_is_written_when_it_is_to_be_kept_and_not_before(tmp_path: Path) -> None:
    recorder = Recorder(tmp_path / "r.mcap", [BASE], ["rmcu"], 0.001, promptly=True)
    recorder.begin()
    for first in range(0, 900, 10):
        recorder.take(samples(BASE, *(5.0 + 0.001 * np.arange(first, first + 10))))
    assert recorder._last_row_s == 0.0
    recorder.keep()
    recorder.writer.settle()
    kept = read_recording(tmp_path / "r.mcap").time_s[-1]
    assert recorder._last_row_s == kept > 0.85
    recorder.writer.close()


def test_rows_of_a_long_run_are_read_from_its_file(
    recorder: Recorder, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("hil.engine.run.recorder.MOST_KEPT_BYTES", 50_000)
    recorder.begin()
    recorder.take(samples(SLOW, *(5.0 + 0.1 * np.arange(40)), value=330.0))
    for first in range(0, 3000, 10):
        recorder.take(samples(BASE, *(5.0 + 0.001 * np.arange(first, first + 10)), value=first))
    seen = recorder.so_far()
    assert len(seen.time_s) > 2900
    recorder.event(5.25, "arm", "armed")
    whole = recorder.finish_rows()
    assert np.array_equal(whole.time_s, np.round(0.001 * np.arange(3000), 9))
    assert np.array_equal(whole["motor_speed_rad_s"], 10.0 * (np.arange(3000) // 10))
    assert np.array_equal(seen["motor_speed_rad_s"], whole["motor_speed_rad_s"][: len(seen.time_s)])
    assert [e.kind for e in whole.events] == ["arm"]
    assert (recorder._chunks, recorder._last_row_s) == (None, 2.999)


def test_a_recording_without_samples_has_its_channels(recorder: Recorder) -> None:
    empty = recorder.finish_rows()
    assert list(empty.channels) == ["time_s", *CHANNELS, "oil_temperature_k"]
    assert len(empty.time_s) == 0


def test_what_comes_too_late_for_its_row_is_counted(recorder: Recorder) -> None:
    recorder.begin()
    recorder.take(samples(BASE, *(5.0 + 0.001 * np.arange(2000))))
    assert len(recorder.so_far().time_s) > 1000
    recorder.take(samples(SLOW, 5.01))
    whole = recorder.finish_rows()
    assert [e.kind for e in whole.events] == ["late"]
    assert whole.events[0].text == "1 samples arrived too late for their row and were discarded"
    assert whole.events[0].time_s == pytest.approx(1.999, abs=1e-6)


def test_how_clocks_went_is_told_without_minus_zeros(tmp_path: Path) -> None:
    counted = Stream(
        "status", "bus 'rmcu'", CHANNELS, ("N m", "rad/s"), 0.001, counting=Counting("8 bits", 256)
    )
    recorder = Recorder(tmp_path / "r.mcap", [counted], ["rmcu"], 0.001)
    recorder.begin()
    numbers = np.array([k for k in range(1000) if k not in (400, 401)])
    recorder.take(Samples(counted, 5.0 + 0.001 * numbers, np.ones((len(numbers), 2)), numbers))
    recorder.finish_rows()
    (clock,) = recorder.clocks()
    recorder.writer.close()
    assert (clock.stream, clock.where, clock.counted_by) == ("status", "bus 'rmcu'", "8 bits")
    assert clock.drift_ppm == pytest.approx(0.0, abs=0.5)
    assert str(clock.drift_ppm) != "-0.0"
    assert clock.offset_s == pytest.approx(0.0, abs=1e-3)
    assert (clock.lost, clock.left_out) == (2, 0)
