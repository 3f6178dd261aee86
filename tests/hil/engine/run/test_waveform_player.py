"""Torque requested one value each tick: all of it, as far as it was wanted, or until the RMCU is in fault."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from hil.core.errors import BenchError, InterruptError
from hil.engine.run.waveform_player import WaveformPlayer
from sim_backend.bench import Fault
from sim_backend.can_interface import attached
from tests.benches_for_tests import running

RAMP = np.linspace(0.0, 12.0, 100)


@pytest.fixture
def bench() -> Iterator[Any]:
    with running("playing") as opened:
        opened.dyno.enable(10.0)
        yield opened


def asked_for(bench: Any) -> float:
    """The torque that the RMCU asks of the inverter now, by its own word."""
    bench.loop.run_for(0.02)
    for source in bench.sources:
        for samples in source.samples():
            if "motor_torque_ref_nm" in samples.stream.channels:
                column = samples.stream.channels.index("motor_torque_ref_nm")
                newest = float(samples.values[-1, column])
    return newest


def test_every_value_is_requested_one_each_tick(bench: Any) -> None:
    playing, began_s = WaveformPlayer(bench, None), bench.loop.clock.now_s()
    assert playing.send("motor_torque", RAMP) == len(RAMP)
    assert playing.passed == len(RAMP)
    assert bench.loop.clock.now_s() - began_s == pytest.approx(0.1, abs=0.0015)
    assert asked_for(bench) == pytest.approx(12.0, abs=0.1)


@pytest.mark.parametrize("wanted", [1, 37, 99])
def test_it_ends_early_where_it_is_told_to_and_what_was_not_sent_is_taken_back(
    bench: Any, wanted: int
) -> None:
    playing = WaveformPlayer(bench, None)
    sent = playing.send("motor_torque", RAMP, lambda: playing.passed >= wanted)
    assert wanted <= sent <= wanted + 10  # up to the next look at the buses they are on their way
    assert playing.send("motor_torque", np.full(200, 5.0)) == 200  # their counters go on: no fault
    assert (bench.rmcu.state, bench.rmcu.fault) == ("torque", "none")
    assert asked_for(bench) == pytest.approx(5.0, abs=0.1)


def test_a_stop_leaves_the_count_of_requests_where_the_rmcu_has_it(bench: Any) -> None:
    def stop() -> None:
        bench.loop.stop_requested = True

    bench.loop.every(0.05, stop)
    with pytest.raises(InterruptError):
        WaveformPlayer(bench, None).send("motor_torque", np.full(500, 5.0))
    bench.loop.stop_requested = False
    bench.loop.shielded = True
    assert WaveformPlayer(bench, None).send("motor_torque", np.full(100, 3.0)) == 100
    assert bench.rmcu.state == "torque"


def test_an_rmcu_in_fault_ends_it_with_the_reason(bench: Any) -> None:
    WaveformPlayer(bench, None).send("motor_torque", RAMP)
    attached("playing").fail(Fault.RMCU_DEAF)
    with pytest.raises(BenchError, match="the RMCU went to fault: timeout") as caught:
        WaveformPlayer(bench, None).send("motor_torque", np.full(500, 5.0))
    assert caught.value.where == "RMCU"


def test_an_rmcu_that_stays_off_is_not_taken_for_one_that_follows(bench: Any) -> None:
    attached("playing").fail(Fault.RMCU_DEAF)
    playing = WaveformPlayer(bench, None)
    with pytest.raises(BenchError, match="the RMCU stays off, though torque is requested"):
        playing.send("motor_torque", np.full(500, 5.0))
    assert playing.passed < 150
