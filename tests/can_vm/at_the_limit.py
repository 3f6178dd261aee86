"""Frames that `cangen` sends at a pace, received and recorded raw, and every counter on the way."""

from __future__ import annotations

import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from drivers import BusHealth, CanSettings, Wire, open_can
from hil.core.can.frames import SENT_BY_HOST, FrameBlock
from hil.core.recording import RecordingWriter, read_frames
from hil.core.runtime.clock import WallClock

FRAME_ID = 0x5A5
_LOOK_S = 0.01
_QUIET_S = 2.0  # without a frame for so long all have come


@dataclass(frozen=True)
class Counted:
    """One stretch: frames a second, and how many there were where.

    `dropped`: of the network interface, by its own counters; `gaps`: in the numbers that the recorded frames
    carry; `remarks`: what the wire says was lost.
    """

    rate: float
    sent: int
    received: int
    recorded: int
    dropped: int
    gaps: int
    remarks: tuple[str, ...]

    @property
    def lossless(self) -> bool:
        """Whether all that was sent stands in the recording, in order."""
        counts = {self.sent, self.received, self.recorded}
        return len(counts) == 1 and not (self.dropped or self.gaps or self.remarks)


def recorded(near: str, far: str, gap_ms: float, count: int, path: Path) -> Counted:
    """Send `count` frames from `far`, `gap_ms` between two of them, and receive them at `near`."""
    before = _dropped(near)
    clock = WallClock()
    offset_s = time.time() - clock.now_s()
    bus = open_can(CanSettings("bus", "socketcan", near, 1_000_000))
    health = BusHealth("bus", "socketcan", bus)
    wire = Wire("bus", bus, clock, epoch_offset_s=offset_s, health=health, echoing=True)
    writer = RecordingWriter(path, ["time_s"], ["bus"])
    command = [
        "cangen",
        far,
        "-g",
        str(gap_ms),
        "-n",
        str(count),
        "-I",
        f"{FRAME_ID:X}",
        "-L",
        "8",
        "-D",
        "i",
    ]
    command += ["-p", "10"]  # waits while the controller's queue is full
    received, first_s, last_s = 0, 0.0, clock.now_s()
    with subprocess.Popen(command) as sender:
        while sender.poll() is None or clock.now_s() - last_s < _QUIET_S:
            block = wire.drain()
            mine = int(np.count_nonzero((block["id"] == FRAME_ID) & (block["flags"] & SENT_BY_HOST == 0)))
            if mine:
                last_s = clock.now_s()
                first_s = first_s or last_s
            received += mine
            writer.add_frames("bus", block)
            time.sleep(_LOOK_S)
    writer.close()
    remarks = tuple(wire.remarks)
    wire.close()
    held = read_frames(path)["bus"]
    mine_held = held[held["id"] == FRAME_ID]
    rate = received / max(last_s - first_s, 1e-3)
    return Counted(rate, count, received, len(mine_held), _dropped(near) - before, _gaps(mine_held), remarks)


def _gaps(held: FrameBlock) -> int:
    """Places where the number that `cangen` counts up in its data does not go on by one."""
    return int(np.count_nonzero(np.diff(held["data"].astype(np.int64)) != 1))


def _dropped(name: str) -> int:
    folder = Path("/sys/class/net", name, "statistics")
    return sum(
        int((folder / what).read_text()) for what in ("rx_dropped", "rx_over_errors", "rx_fifo_errors")
    )
