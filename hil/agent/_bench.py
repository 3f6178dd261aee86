"""A bench of the agent: what it does now, what is asked of it, and what is predicted there."""

from __future__ import annotations

import contextlib
import logging
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from hil.agent._kept_runs import KeptRun
from hil.agent._service import AwayError, TheService
from hil.api_schemas.agent import AgentBench, AgentsForecast, Order, PlanSent
from hil.api_schemas.api import ForecastData, Problem
from hil.client import RefusedError
from hil.core.errors import BadInputError, BenchError, HilError
from hil.core.errors.wording import printable, shortened
from hil.core.files import write_atomically
from hil.engine.ipc.ipc_messages import EmergencyAsked
from hil.execution.benches import Bench
from hil.execution.forecasts import Forecasts
from hil.execution.run_execution import RunExecution
from test_plans import plan_from_text

_LONGEST = 2000
_USED_S = 1.0

logger = logging.getLogger(__name__)


class DrivenBench:
    """A bench and its run, from when that is taken until the service has it.

    Attributes:
        kept: the run that the service has not yet.
        running: the same while its process is ours.
        left: whether it is one of an agent that was killed, perhaps still ending.
    """

    def __init__(self, bench: Bench) -> None:
        self.bench = bench
        self.kept: KeptRun | None = None
        self.running: RunExecution | None = None
        self.left = False
        self.refused = ""
        self._used_by, self._looked_s = "", -1e9

    @property
    def name(self) -> str:
        """As it is called in its file."""
        return self.bench.name

    def report(self) -> AgentBench:
        """What the service gets to know of it."""
        bench, running = self.bench, self.running
        facts = AgentBench(
            name=bench.name,
            title=printable(bench.title, 200),
            simulated=bench.simulated,
            limits=bench.limits,
            units=bench.units,
            state="free",
            running=self.kept.id if self.kept else None,
        )
        stopped = bench.stopped()
        if running is not None:
            facts.share = None if running.share is None else min(max(running.share, 0.0), 1.0)
            facts.doing, facts.message = _short(running.doing), _short(running.message)
            facts.prompt = running.prompt
        elif self.left:
            facts.doing = "the run is being ended, because its agent was killed"
        elif self.kept is not None:
            facts.doing, facts.share = "its files are being uploaded", 1.0
        if stopped:
            facts.state, facts.why = "emergency_stop", _short(stopped)
        elif self.kept is not None:
            facts.state, facts.why = "ending" if self.left else "running", facts.doing
        elif used := self._used():
            facts.state, facts.why = "in_use", _short(used)
        return facts

    def obey(self, order: Order) -> bool:
        """Do what somebody asks; false if it has to be tried again. What is too late is done."""
        try:
            if order.kind == "emergency_stop":
                self._stop_in_emergency(order)
            elif order.kind == "reset":
                self.bench.reset(order.by)
            elif self.running is not None and order.run == self.running.data.id:
                self._steer(self.running, order)
        except HilError as error:
            logger.error("%s: %s", self.name, error)
            return False
        return True

    def _used(self) -> str:
        """Who else drives it, as of a second ago: a look takes the bench's lock for a moment."""
        if time.monotonic() - self._looked_s > _USED_S:
            self._used_by, self._looked_s = self.bench.used_by(), time.monotonic()
        return self._used_by

    def _stop_in_emergency(self, order: Order) -> None:
        if self.running is not None:
            asked = EmergencyAsked(by=order.by, origin=order.origin, way=order.way or "api")
            self.running.process.stop_in_emergency(asked)
        folder = self.kept.folder if self.kept is not None else Path()
        self.bench.stop(order.by, folder, origin=order.origin, way=order.way or "api")

    def _steer(self, running: RunExecution, order: Order) -> None:
        process = running.process
        known: dict[str, Callable[[], None]] = {
            "pause": process.pause,
            "resume": process.resume,
            "end": process.end,
            "answer": lambda: process.answer(order.text),
        }
        known[order.kind]()


def _short(text: str) -> str:
    return shortened(text, _LONGEST)


class Forecasting:
    """Checks plans in processes of their own, for whoever asks the service."""

    def __init__(self, service: TheService, agent: str) -> None:
        self._forecasts, self._service, self._agent = Forecasts(), service, agent

    async def answer(self, order: Order, bench: Bench) -> None:
        """Predict and tell; a service that does not wait any more need not hear it."""
        found = await self._found(order.plan, bench)
        with contextlib.suppress(AwayError, RefusedError):
            await self._service.ask(lambda client: client.answer_forecast(self._agent, order.id, found))

    async def _found(self, plan: PlanSent | None, bench: Bench) -> AgentsForecast:
        try:
            if plan is None:
                raise BenchError("the order has no plan", where="forecast")
            return AgentsForecast(forecast=await self._forecast(plan, bench))
        except (HilError, OSError) as error:
            refused = isinstance(error, BadInputError)
            shown = error if isinstance(error, HilError) else BenchError(str(error), where="forecast")
            problem = Problem(what=shown.what, where=shown.where, fix=shown.fix)
            return AgentsForecast(problem=problem, refused=refused)

    async def _forecast(self, sent: PlanSent, bench: Bench) -> ForecastData:
        with tempfile.TemporaryDirectory(prefix="hil-agent-") as folder:
            for name, text in sent.files.items():
                write_atomically(Path(folder) / Path(name).name, text)
            source = Path(folder) / Path(sent.source).name
            write_atomically(source, sent.text)
            plan = plan_from_text(sent.text, str(source), source.parent)
            return await self._forecasts.of(plan, bench.read_again())
