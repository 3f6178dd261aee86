"""What is loaded before a bench is armed leaves no trace on it."""

from __future__ import annotations

import numpy as np

from hil.core.can.frames import SENT_BY_HOST
from hil.engine.run.jit_warm_up import warm_up
from tests.benches_for_tests import running


def test_made_up_samples_reach_nobody_and_nothing_is_sent() -> None:
    sent: list[int] = []
    with running("warm") as bench:
        for source in bench.sources:
            list(source.samples())
        bench.loop.on_block(
            lambda bus, block: sent.extend(block["id"][block["flags"] & SENT_BY_HOST > 0].tolist())
        )
        state, counter = bench.rmcu.state, int(bench.rmcu.requests("off", np.zeros(1))[0]) & 15
        warm_up(bench)
        assert [samples for source in bench.sources for samples in source.samples()] == []
        assert int(bench.rmcu.requests("off", np.zeros(1))[0]) & 15 == (counter + 1) % 16
        bench.loop.run_for(0.02)
        assert bench.rmcu.state == state
        assert set(sent) <= {0x77F}  # the host's own heartbeat
