"""Loads compiled code before any device watches its host: loading takes longer than devices wait."""

from __future__ import annotations

import contextlib

import numpy as np

from drivers import TICK_S, FrameSource, NewestFrames, SampleAssembler, Samples, Stream
from hil.core.can.frames import EXTENDED, FRAME, inserted
from hil.core.errors import BenchError
from hil.engine.bench.bench import Bench
from hil.engine.run.limits import LimitWatch

_STRETCH_S = 0.7  # longer than rows are collected
_COUNTER_VALUES = 16  # as many requests leave the counter of requests where it was


def warm_up(bench: Bench) -> None:
    """Put made-up samples through all that samples go through; nothing of it stays, nothing is sent."""
    assembler = SampleAssembler(bench.streams, TICK_S)
    watch = LimitWatch(bench.streams, bench.file.limits)
    for stretch in range(2):
        for stream in bench.streams:
            samples = _made_up(stream, stretch)
            (assembler.add if stretch else assembler.learn)(samples)
            watch.take(samples, 0.0)
    assembler.rows()
    with contextlib.suppress(BenchError):  # what is made up may look as it likes
        assembler.look_for_parted_clocks()
    assembler.time_of(0.0)
    assembler.rows(everything=True)
    bench.rmcu.requests("off", np.zeros(_COUNTER_VALUES))
    _warm_up_frames(bench)


def _warm_up_frames(bench: Bench) -> None:
    """Blocks of one frame are compiled for by themselves: their columns lie without gaps."""
    blocks = [np.zeros(count, FRAME) for count in (1, 2)]
    for block in blocks:
        block["flags"] = EXTENDED  # no one listens to those
        NewestFrames({0: ()}).of(block)
        for other in blocks:
            inserted(block, other)
        for wire in bench.loop.wires:
            bench.loop.hand_out(wire.name, block)
            for source in bench.sources:
                if isinstance(source, FrameSource):
                    source.take(wire.name, block)


def _made_up(stream: Stream, stretch: int) -> Samples:
    numbers = np.arange(round(_STRETCH_S / stream.period_s)) + stretch * round(_STRETCH_S / stream.period_s)
    turn = 256 if stream.counting else 0
    counts = numbers + turn if stream.counting else None
    times_s = np.asarray(numbers * stream.period_s, np.float64)
    return Samples(stream, times_s, np.zeros((len(numbers), len(stream.channels))), counts)
