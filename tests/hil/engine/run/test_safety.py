"""The way to the safe state: no one's failure keeps another device from being served."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from drivers import SampleSource
from hil.core.errors import BenchError
from hil.engine.run.safety import reach_safe_state
from sim_backend.bench import Fault
from sim_backend.can_interface import attached
from tests.benches_for_tests import running


class Valve:
    """A device that is told to close, and fails in a way of its own."""

    name = "valve"
    sources: Sequence[SampleSource] = ()
    heartbeat_s = None

    def __init__(
        self, failure: Exception | None = None, *, closes_after: int = 1, within_s: float = 0.05
    ) -> None:
        self.told, self.asked = 0, 0
        self.safe_within_s = within_s
        self._failure, self._closes_after = failure, closes_after

    def come_up(self) -> None: ...

    def beat(self) -> None: ...

    def troubles(self) -> list[str]:
        return []

    def make_safe(self) -> None:
        self.told += 1
        if self._failure:
            raise self._failure

    def is_safe(self) -> bool:
        self.asked += 1
        return self._failure is None and self.told >= self._closes_after

    def close(self) -> None: ...


def test_all_devices_are_made_safe_at_once_and_nobody_complains() -> None:
    with running("safety") as bench:
        bench.dyno.enable(10.0)
        for payload in bench.rmcu.requests("motor_torque", np.full(20, 15.0)):
            bench.rmcu.send(payload)
            bench.loop.step()
        assert not bench.dyno.is_safe()
        start_s = bench.loop.clock.now_s()
        assert reach_safe_state(bench) == []
        assert bench.loop.shielded
        assert bench.rmcu.is_safe()
        assert bench.dyno.is_safe()
        assert bench.loop.clock.now_s() - start_s < max(bench.rmcu.safe_within_s, bench.dyno.safe_within_s)


@pytest.mark.parametrize(
    ("failure", "said", "faults"),
    [
        (BenchError("the line is cut", where="valve"), ": the line is cut", 0),
        (KeyError("position"), ": KeyError: 'position'", 1),
    ],
)
def test_a_device_that_fails_is_told_of_and_the_others_are_safe(
    failure: Exception, said: str, faults: int
) -> None:
    with running("safety-fails") as bench:
        valve = bench.further["valve"] = Valve(failure)
        bench.dyno.enable(10.0)
        seen: list[Exception] = []
        complaints = reach_safe_state(bench, seen.append)
        assert complaints == [f"valve did not confirm its safe state within 0.05 s{said}"]
        assert len(seen) == faults  # the program's mistake is reported once, however often it is tried
        assert valve.told > 1
        assert bench.dyno.is_safe()


class Unasked(Valve):
    """Closes, but a fault in its code keeps it from saying so."""

    def is_safe(self) -> bool:
        raise ZeroDivisionError("no reading")


def test_of_a_device_that_cannot_be_asked_nothing_is_known() -> None:
    with running("safety-unasked") as bench:
        bench.further["valve"] = Unasked()
        seen: list[Exception] = []
        (complaint,) = reach_safe_state(bench, seen.append)
        said = "valve did not confirm its safe state within 0.05 s: ZeroDivisionError: no reading"
        assert complaint == said
        assert len(seen) == 1
        assert bench.rmcu.is_safe()


def test_a_device_is_told_every_10_ms_until_it_is_there() -> None:
    with running("safety-slow") as bench:
        valve = bench.further["valve"] = Valve(closes_after=4, within_s=1.0)
        start_s = bench.loop.clock.now_s()
        reach_safe_state(bench)
        passed_s = bench.loop.clock.now_s() - start_s
        assert valve.told >= 4
        assert 0.03 <= passed_s < 0.2


def test_a_silent_device_has_its_own_deadline_and_the_reason_is_its_silence() -> None:
    with running("safety-silent") as bench:
        bench.dyno.enable(10.0)
        attached("safety-silent").fail(Fault.RMCU_SILENT)
        bench.loop.run_for(0.15)
        start_s = bench.loop.clock.now_s()
        (complaint,) = reach_safe_state(bench)
        within_s = bench.rmcu.safe_within_s
        assert complaint == f"{bench.rmcu.name} did not confirm its safe state within {within_s:g} s"
        assert bench.loop.clock.now_s() - start_s == pytest.approx(within_s, abs=0.002)
        assert bench.dyno.is_safe()


@pytest.mark.parametrize(
    ("error", "faults"), [(KeyError("duty"), 1), (BenchError("bus off", where="bus"), 0)]
)
def test_a_loop_that_fails_keeps_nobody_from_being_served(error: Exception, faults: int) -> None:
    with running("safety-loop") as bench:
        bench.dyno.enable(10.0)

        def fail() -> None:
            raise error

        bench.loop.on_drained(fail)
        seen: list[Exception] = []
        assert reach_safe_state(bench, seen.append) == []
        assert len(seen) == faults
        assert bench.dyno.is_safe()
