"""Frames of an RMCU and of two dynos as an adapter hands them over: late, in bunches, lost, sent twice."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from drivers import Binding, CountedBy, FrameSource, SampleAssembler
from hil.core.can.frames import FRAME, FrameBlock
from hil.core.can.signals import Signal

PERIOD_S = 1e-3
VALUE = Signal("Value", 0, 32)
SYNC, LEFT, RIGHT, STATUS, CONTROL = 0x80, 0x183, 0x184, 0x110, 0x111
BEGIN = 300  # samples before the recording begins


def counter(bits: int) -> Signal:
    """A counter behind the value."""
    return Signal("Counter", 32, bits)


@dataclass
class Wire:
    """One bus with the frames of each sample in their order, and what becomes of them on the way."""

    bus: str
    ids: tuple[int, ...]
    clock_offset_s: float = 0.0
    drift: float = 0.0
    lost: set[tuple[int, int]] = field(default_factory=set)  # sample and identifier
    twice: set[tuple[int, int]] = field(default_factory=set)

    def sent(self, samples: int, bits: int = 8) -> FrameBlock:
        """All frames, in the order in which they were sent, with the times at which they were on the bus."""
        frames = []
        for k in range(samples):
            for place, frame_id in enumerate(self.ids):
                time_s = 5.0 + self.clock_offset_s + k * PERIOD_S * (1 + self.drift) + 1.35e-4 * (place + 1)
                frame = (time_s, frame_id, 0, 8, k | (k % (1 << bits)) << 32)
                if (k, frame_id) not in self.lost:
                    frames += [frame] * (2 if (k, frame_id) in self.twice else 1)
        return np.array(frames, FRAME)


def in_bursts(block: FrameBlock, every_s: float, phase_s: float = 0.0) -> FrameBlock:
    """Handed over at whole multiples of a time, stamped then."""
    late = block.copy()
    late["time_s"] = np.ceil((block["time_s"] - phase_s) / every_s) * every_s + phase_s
    return late


def held_up(block: FrameBlock, delays_s: np.ndarray) -> FrameBlock:
    """Each frame late by its delay; none overtakes another."""
    late = block.copy()
    before_s = block["time_s"][0] + np.max(delays_s[: len(delays_s) // 4])  # it was so already
    late["time_s"] = np.maximum(np.maximum.accumulate(block["time_s"] + delays_s), before_s)
    return late


def rmcu_source(bits: int) -> FrameSource:
    """Status, and control frames with a counter, as the RMCU's driver binds them."""
    bindings = [Binding("rmcu", STATUS, VALUE, "motor_speed_rad_s"), Binding("rmcu", CONTROL, VALUE, "state")]
    return FrameSource(bindings, PERIOD_S, CountedBy("rmcu", CONTROL, "RMCU_Control", counter(bits)))


def dyno_source() -> FrameSource:
    """Values of both sides, counted by SYNC."""
    bindings = [
        Binding("dyno", LEFT, VALUE, "shaft_torque_left_nm"),
        Binding("dyno", RIGHT, VALUE, "shaft_torque_right_nm"),
    ]
    return FrameSource(bindings, PERIOD_S, CountedBy("dyno", SYNC, "SYNC", opens=True))


def recorded(
    rmcu: FrameBlock, dyno: FrameBlock, bits: int = 8
) -> tuple[SampleAssembler, dict[str, np.ndarray]]:
    """Columns of the rows that the frames become; the first `BEGIN` samples are before the recording."""
    sources = [rmcu_source(bits), dyno_source()]
    assembler = SampleAssembler([stream for source in sources for stream in source.streams], PERIOD_S)
    chunks = []
    ends = np.arange(5.0, max(np.max(rmcu["time_s"]), np.max(dyno["time_s"])) + 0.02, 0.01)
    at = [0, 0]
    for tick, end_s in enumerate(ends):
        for index, (bus, block) in enumerate((("rmcu", rmcu), ("dyno", dyno))):
            stop = at[index] + int(np.sum(np.maximum.accumulate(block["time_s"][at[index] :]) <= end_s))
            sources[index].take(bus, block[at[index] : stop])
            at[index] = stop
            for samples in sources[index].samples():
                if end_s < 5.0 + BEGIN * PERIOD_S:
                    assembler.learn(samples)
                else:
                    assembler.add(samples)
        if tick % 50 == 49:
            chunks.append(assembler.rows())
    chunks.append(assembler.rows(everything=True))
    rows = np.concatenate(chunks)
    return assembler, dict(zip(assembler.names, rows.T, strict=True))
