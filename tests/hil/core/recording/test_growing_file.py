"""What is on the disk while a recording still grows, and when its disk is full."""

from __future__ import annotations

import contextlib
import os
import select
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from mcap.records import Message
from mcap.stream_reader import StreamReader

from hil.core.can.frames import FRAME
from hil.core.recording import RecordingWriter, read_frames, read_recording
from hil.core.recording._growing_file import GrowingFile

NAMES = ["time_s", "motor_torque_ref_nm", "motor_speed_rad_s"]
ROW_0_S = 0.4
GROWING = """
import sys, time
from pathlib import Path
from tests.hil.core.recording.test_growing_file import grow
for _ in grow(Path(sys.argv[1]), durable=True):
    print(_, flush=True)
    time.sleep(0.02)
"""


def grow(path: Path, *, durable: bool = False, seconds: float = 60.0):
    """A bench's way: frames at once, rows 3 ms later, flushed every 0.15 s; tells the newest row's time."""
    writer = RecordingWriter(path, NAMES, ["rmcu"], durable=durable)
    writer.row_0_s = ROW_0_S
    written = 0
    for tick in range(int(seconds * 100)):
        block = np.zeros(10, FRAME)
        block["time_s"] = ROW_0_S + (10 * tick + np.arange(10)) * 1e-3
        block["length"] = 8
        writer.add_frames("rmcu", block)
        if tick % 15 == 14:
            count = 10 * tick + 7 - written
            rows = np.ones((count, len(NAMES)))
            rows[:, 0] = (written + np.arange(count)) * 1e-3
            writer.add_rows(rows)
            writer.flush()
            written += count
            yield rows[-1, 0]
    writer.close()


def test_all_that_was_flushed_is_there_after_a_kill(tmp_path: Path) -> None:
    path = tmp_path / "r.mcap"
    with subprocess.Popen(
        [sys.executable, "-c", GROWING, path], stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout
        told = [float(process.stdout.readline()) for _ in range(8)]
        time.sleep(0.01)  # the thread that writes has its turn
        process.send_signal(signal.SIGKILL)
        told += [float(line) for line in process.stdout.read().split()]
    read = read_recording(path)
    assert told[-1] <= read.time_s[-1] <= told[-1] + 0.151
    frames = read_frames(path)["rmcu"]
    assert told[-1] - 0.051 <= frames["time_s"][-1] - ROW_0_S <= read.time_s[-1] + 0.011  # blocks of 50 ms
    assert np.all(np.diff(frames["time_s"]) < 0.0011)  # none is missing in between


def test_flushed_messages_lie_in_order_of_time(tmp_path: Path) -> None:
    for _ in grow(tmp_path / "r.mcap", seconds=3.0):
        pass
    with (tmp_path / "r.mcap").open("rb") as file:
        times = [r.log_time for r in StreamReader(file, validate_crcs=True).records if isinstance(r, Message)]
    assert times == sorted(times)
    assert times[0] == pytest.approx(ROW_0_S * 1e9, abs=1e7)


def test_frames_of_a_bench_whose_time_base_is_silent_wait_a_quarter_of_a_second(tmp_path: Path) -> None:
    growing = grow(tmp_path / "r.mcap", seconds=60.0)
    next(growing)
    writer = growing.gi_frame.f_locals["writer"]
    for part in range(40):
        block = np.zeros(10, FRAME)
        block["time_s"] = 1.0 + 0.01 * part + np.arange(10) * 1e-3
        writer.add_frames("rmcu", block)
        writer.flush()
    assert read_frames(tmp_path / "r.mcap")["rmcu"]["time_s"][-1] >= 1.4 - 0.26
    writer.close()


@pytest.fixture
def taking_nothing(tmp_path: Path) -> Iterator[tuple[Path, int]]:
    """A file that takes 64 kB, and then nothing until somebody reads from the descriptor."""
    path = tmp_path / "stuck"
    os.mkfifo(path)
    reading = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    yield path, reading
    os.close(reading)


def drained(reading: int, count: int) -> bytes:
    got = b""
    while len(got) < count and select.select([reading], [], [], 5.0)[0]:
        got += os.read(reading, 1 << 16)
    return got


def test_a_disk_that_takes_nothing_holds_nobody_up_and_gets_all_in_order(taking_nothing) -> None:
    path, reading = taking_nothing
    file = GrowingFile(path, durable=True)
    pieces = [bytes([number]) * 50_000 for number in range(10)]
    for piece in pieces:
        file.write(piece)
    assert file.tell() == 500_000
    assert drained(reading, 500_000) == b"".join(pieces)
    file.settle()
    with contextlib.suppress(OSError):  # nothing but a file can be put on a disk
        file.close()


def test_a_disk_that_takes_nothing_for_long_ends_the_recording(taking_nothing, monkeypatch) -> None:
    monkeypatch.setattr("hil.core.recording._growing_file.HANGS_AFTER_S", 0.2)
    path, reading = taking_nothing
    file = GrowingFile(path, durable=True)
    file.write(bytes(200_000))
    time.sleep(0.3)
    with pytest.raises(OSError, match="taken nothing for"):
        file.write(b"more")
    drained(reading, 200_000)
    file.close()  # it has been reported


def test_what_a_thread_could_not_write_is_told_once_at_the_next_write_or_at_the_end(tmp_path: Path) -> None:
    for more in (True, False):
        file = GrowingFile(tmp_path / f"{more}", durable=True)
        file.write(b"whole")
        file.settle()
        read_only = os.open("/dev/null", os.O_RDONLY)
        os.dup2(read_only, file._raw.fileno())
        os.close(read_only)
        file.write(b"lost")
        file.settle()
        if more:
            with pytest.raises(OSError, match="Bad file descriptor"):
                file.write(b"not tried")
            file.close()
        else:
            with pytest.raises(OSError, match="Bad file descriptor"):
                file.close()
        assert (tmp_path / f"{more}").read_bytes() == b"whole"


def test_a_sync_is_no_part_of_writing_and_ends_with_the_file(tmp_path: Path) -> None:
    before = set(threading.enumerate())
    growing = grow(tmp_path / "r.mcap", durable=True, seconds=0.6)
    next(growing)
    time.sleep(0.3)
    assert len(list(growing)) == 3
    assert set(threading.enumerate()) <= before
    assert read_recording(tmp_path / "r.mcap").damage == []
