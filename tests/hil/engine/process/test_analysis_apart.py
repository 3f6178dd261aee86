"""Analysis inside of a run: heartbeats go on, and whatever ends the run ends it."""

from __future__ import annotations

import os
import time
from collections.abc import Mapping
from pathlib import Path
from typing import ClassVar

import pytest

from hil.core.errors import BenchError, EmergencyStopError, InterruptError
from hil.core.recording import Recording
from hil.engine import RunRequest, run_plan
from hil.engine.ipc.ipc import analysed_apart
from hil.engine.ipc.ipc_messages import EmergencyAsked
from test_plans import Conductor, Outlook, Pace, Plan, Step
from tests.benches_for_tests import plan, sim_bench
from tests.hil.engine.run.test_wall_clock import bench_in_real_time, ran_in_real_time
from tests.operators import Silent


class Ponder(Step):
    """An analysis that never lets go of the interpreter, for a time."""

    kind: ClassVar[str] = "ponder"
    for_s: float

    def execute(self, conductor: Conductor) -> None:
        conductor.analyse("ponder", self._work, ("pid.txt",))

    def outlook(self, speed_m_s: float, pace: Pace) -> Outlook:
        return Outlook(0.0, speed_m_s)

    def _work(self, recording: Recording, made: Path) -> Mapping[str, bytes]:
        (made / "started").write_text(str(os.getpid()))
        until_s = time.monotonic() + self.for_s
        while time.monotonic() < until_s:
            sum(range(100_000))
        return {"pid.txt": str(os.getpid()).encode()}


def pondering(for_s: float) -> Plan:
    asked = plan("[{hold_speed: {speed_km_h: 2, duration_s: 0.1}}]")
    return asked.model_copy(update={"steps": (*asked.steps, Ponder(for_s=for_s))})


def is_gone(number: int) -> bool:
    """A process that has been killed is gone once its parent has looked."""
    for _ in range(100):
        try:
            os.kill(number, 0)
        except ProcessLookupError:
            return True
        time.sleep(0.02)
    return False


@pytest.mark.slow
def test_on_hardware_it_is_done_by_another_process_while_heartbeats_go_on(tmp_path: Path) -> None:
    outcome = ran_in_real_time("pondering", lambda bench, _: RunRequest(pondering(0.5), bench, tmp_path))
    assert outcome.result.safe_state == "confirmed"
    assert int((tmp_path / "pid.txt").read_text()) != os.getpid()


@pytest.mark.parametrize(("typed", "kind"), [("", InterruptError), ("e", EmergencyStopError)])
def test_what_ends_the_run_ends_it(typed: str, kind: type[Exception], tmp_path: Path) -> None:
    class Impatient(Silent):
        def typed(self) -> list[str | EmergencyAsked]:
            if not (tmp_path / "started").exists() or not (tmp_path / "started").read_text():
                return []
            if not typed:
                request.stop.ask()
            return [typed]

    name = f"impatient{typed}"
    request = RunRequest(
        pondering(3600.0), sim_bench(name), tmp_path, terminal=Impatient(), analyse=analysed_apart
    )
    outcome = run_plan(request)
    assert isinstance(outcome.error, kind)
    assert outcome.result.safe_state == "confirmed"
    assert is_gone(int((tmp_path / "started").read_text()))


@pytest.mark.slow
def test_the_safe_state_does_not_wait_for_it(tmp_path: Path) -> None:
    with bench_in_real_time("unplugged-pondering") as (bench, unplugged, _):
        request = RunRequest(pondering(3600.0), bench, tmp_path)
        request.progress = lambda share, text: unplugged.set() if (tmp_path / "started").exists() else None
        outcome = run_plan(request)
    assert type(outcome.error) is BenchError
    assert is_gone(int((tmp_path / "started").read_text()))
