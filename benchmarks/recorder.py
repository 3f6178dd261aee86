"""How many frames a second of python-can's virtual bus one process can record raw, and what bounds it.

`python -m benchmarks.recorder`, in processor time of the one thread that sends, receives and writes; each
part by itself, and together. The recording is read again and every frame counted.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import can
import numpy as np

from drivers import CanSettings, Wire, open_can
from hil.core.can.frames import FRAME, FrameBlock
from hil.core.recording import RecordingWriter, read_frames
from hil.core.runtime.clock import WallClock

FRAMES, AT_ONCE = 400_000, 1000
WANTED = 100_000
_CHANNEL = "recorder"


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        sent_s, received_s = on_the_bus()
        written_s, read_back = written(Path(folder) / "arrays.mcap")
        together_s, recorded = recorded_from_the_bus(Path(folder) / "bus.mcap")
    print(f"{'':44}{'frames/s':>12}")
    for name, seconds in (
        ("python-can's virtual bus: send", sent_s),
        ("python-can's virtual bus: recv, to arrays", received_s),
        ("arrays to MCAP, compressed, on disk", written_s),
        ("received and recorded", together_s),
        ("the same with the sender in the same thread", sent_s + together_s),
    ):
        print(f"{name:44}{FRAMES / seconds:12,.0f}")
    print(f"frames read again: {read_back:,} and {recorded:,} of {FRAMES:,} sent")
    can_be = "can" if FRAMES / together_s >= WANTED else "cannot"
    all_s = sent_s + together_s
    print(
        f"{WANTED:,} frames/s {can_be} be recorded. python-can's virtual bus costs one process: sending "
        f"{sent_s / all_s:.0%}, handing out frames one by one {received_s / all_s:.0%}; writing alone would "
        f"bound it at {FRAMES / written_s:,.0f}"
    )


def on_the_bus() -> tuple[float, float]:
    """Seconds for sending, and for receiving, of all frames."""
    sent_s = received_s = 0.0
    with _Bus() as bus:
        for count in _portions():
            began = time.thread_time()
            bus.send(count)
            sent = time.thread_time()
            assert len(bus.wire.drain()) == count
            sent_s += sent - began
            received_s += time.thread_time() - sent
    return sent_s, received_s


def written(path: Path) -> tuple[float, int]:
    """Seconds for writing blocks of frames; how many the file holds then."""
    writer = RecordingWriter(path, ["time_s"], ["bus"])
    block = np.zeros(AT_ONCE, FRAME)
    block["id"], block["length"] = np.arange(AT_ONCE) % 0x800, 8
    block["data"] = np.random.default_rng(1).integers(0, 1 << 62, AT_ONCE)
    began = time.thread_time()
    for number, _ in enumerate(_portions()):
        block["time_s"] = (number * AT_ONCE + np.arange(AT_ONCE)) / WANTED
        writer.add_frames("bus", block.copy())
    writer.close()
    return time.thread_time() - began, _held(path)


def recorded_from_the_bus(path: Path) -> tuple[float, int]:
    """Seconds for taking from the bus and writing, without those for sending; frames in the file."""
    seconds = 0.0
    with _Bus() as bus:
        writer = RecordingWriter(path, ["time_s"], ["bus"])
        for count in _portions():
            bus.send(count)
            began = time.thread_time()
            writer.add_frames("bus", bus.wire.drain())
            seconds += time.thread_time() - began
        began = time.thread_time()
        writer.close()
        bus.wire.close()
    return seconds + time.thread_time() - began, _held(path)


class _Bus:
    """Both ends of python-can's virtual bus."""

    def __enter__(self) -> _Bus:
        clock = WallClock()
        offset_s = time.time() - clock.now_s()
        self._far = can.Bus(interface="virtual", channel=_CHANNEL)
        settings = CanSettings("bus", "virtual", _CHANNEL, 1_000_000)
        self.wire = Wire("bus", open_can(settings), clock, epoch_offset_s=offset_s)
        return self

    def __exit__(self, *error: object) -> None:
        self.wire.close()
        self._far.shutdown()

    def send(self, count: int) -> None:
        for number in range(count):
            self._far.send(
                can.Message(arbitration_id=number % 0x800, is_extended_id=False, data=bytes(8), check=False)
            )


def _portions() -> Iterator[int]:
    for _ in range(FRAMES // AT_ONCE):
        yield AT_ONCE


def _held(path: Path) -> int:
    blocks: dict[str, FrameBlock] = read_frames(path)
    return len(blocks["bus"])


if __name__ == "__main__":
    main()
