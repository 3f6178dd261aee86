"""An agent from its folder to its end: it tells, obeys, takes runs, and sees each through."""

from __future__ import annotations

import asyncio
import contextlib
import importlib.metadata
import logging
import math
import socket
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from hil.agent._bench import DrivenBench, Forecasting
from hil.agent._kept_runs import Deliveries, KeptRun, KeptRuns
from hil.agent._service import AwayError, TheService
from hil.api_schemas.agent import AgentOrders, AgentReport, RunEnding, TakenRun
from hil.client import RefusedError
from hil.core.errors import BadInputError, BenchError, HilError
from hil.core.errors.wording import shortened
from hil.engine import StopRequest
from hil.execution.benches import benches_of
from hil.execution.data_folder import alone_in, name_in
from hil.execution.run_execution import RunEnd, RunExecution, end_of_left
from hil.execution.run_process import alive_in

_LOOK_S = 0.1
_REPORT_S = 0.2  # at least; the service holds a report for up to half a second
_AGAIN_S = 1.0
_LAST_S = 10.0  # for the files of a run that was ended with the agent
_LONGEST_REASON, _LONGEST_DUT = 20_000, 200

_OTHER_FOLDER = "give another folder with --data; one agent may have several benches"

logger = logging.getLogger(__name__)


@dataclass
class AgentRequest:
    """An agent that is wanted.

    Attributes:
        servers: URLs of the service, or of several with one database.
        folder: where runs and the agent's name for the service are kept; made if it is not there.
        benches: bench files, or names of shipped ones.
        local_days: how long files stay that the service has.
        for_s: ends by itself after this many seconds.
        ready: called when the service has answered, with '', or has not, with why.
    """

    servers: Sequence[str]
    folder: Path
    benches: Sequence[str]
    token: str = ""
    name: str = field(default_factory=socket.gethostname)
    local_days: float = 30.0
    for_s: float = math.inf
    ready: Callable[[str], None] = lambda away: None
    stop: StopRequest = field(default_factory=StopRequest)


def work(request: AgentRequest) -> None:
    """Work until somebody asks to stop; runs under way are ended then, and their benches safe.

    Raises:
        BadInputError: folder, bench files or token cannot be used.
        BenchError: the service has given one of the benches' names to another.
    """
    named = benches_of(list(request.benches), request.folder.resolve())
    benches = [DrivenBench(bench) for bench in named.values()]
    with alone_in(request.folder, who="agent", fix=_OTHER_FOLDER):
        asyncio.run(_Agent(request, benches).work())


class _Agent:
    def __init__(self, request: AgentRequest, benches: list[DrivenBench]) -> None:
        self._request, self._benches = request, {bench.name: bench for bench in benches}
        self._id = name_in(request.folder, "agent.id")
        self._runs = KeptRuns(request.folder / "runs", request.local_days)
        self._service = TheService(request.servers, request.token)
        self._deliveries = Deliveries(self._service, self._id)
        self._forecasting = Forecasting(self._service, self._id)
        self._obeyed: list[str] = []
        self._answers: set[asyncio.Task[None]] = set()
        self._tasks: set[asyncio.Task[None]] = set()
        self._closing = self._over = False
        self._heard = False  # whether a service has ever answered

    async def work(self) -> None:
        self._runs.clear()
        for run in self._runs.pending():
            bench = self._benches.get(run.bench)
            if bench is not None:
                bench.kept, bench.left = run, run.ending is None
            self._see_through(run, bench)
        reports = asyncio.create_task(self._report_again_and_again())
        until_s = time.monotonic() + self._request.for_s
        while not (self._request.stop.times or time.monotonic() > until_s or reports.done()):
            await asyncio.sleep(_LOOK_S)
        await self._close()
        self._over = True
        await reports  # what ended it is reported, and none comes after the last
        if not self._service.away:
            with contextlib.suppress(AwayError, RefusedError):
                await self._reported(leaving=True)

    async def _close(self) -> None:
        """End what is under way, and bring it to the service if that can be done soon."""
        self._closing = True
        for bench in self._benches.values():
            if bench.running is not None:
                bench.running.process.leave()
        last_s = math.inf
        while self._tasks and self._request.stop.times < 2 and time.monotonic() < last_s:
            await asyncio.wait(self._tasks, timeout=_LOOK_S)
            if not any(bench.running for bench in self._benches.values()):
                last_s = min(last_s, time.monotonic() + (0.0 if self._service.away else _LAST_S))
        for task in self._tasks:
            task.cancel()

    async def _report_again_and_again(self) -> None:
        while not self._over:
            began_s = time.monotonic()
            try:
                orders = await self._reported()
            except AwayError as error:
                self._first_answer(error.what)
                await asyncio.sleep(_AGAIN_S)
                continue
            except RefusedError as error:
                if not self._heard:
                    fix = _TOKEN_FIX if error.status in (401, 403) else _URL_FIX
                    raise BadInputError(error.what, where=self._service.url, fix=fix) from error
                logger.warning("the service refuses what is reported: %s", error.what)
                await asyncio.sleep(_AGAIN_S)
                continue
            self._refuse(orders)
            self._first_answer("")
            self._heard = True
            for name in orders.waiting:
                await self._take(self._benches[name])
            await asyncio.sleep(max(0.0, _REPORT_S - (time.monotonic() - began_s)))

    async def _reported(self, *, leaving: bool = False) -> AgentOrders:
        """Tell what the benches do, and obey.

        Raises:
            AwayError, RefusedError: the service does not answer, or refuses.
        """
        report = AgentReport(
            name=self._request.name,
            machine=socket.gethostname(),
            version=importlib.metadata.version("eaxle-hil"),
            benches=[bench.report() for bench in self._benches.values()],
            obeyed=self._obeyed,
            leaving=leaving,
        )
        orders = await self._service.ask(lambda client: client.report(self._id, report))
        known = set(self._obeyed)
        self._obeyed = []
        for order in orders.orders:
            bench = self._benches.get(order.bench)
            if order.id in known or bench is None or bench.obey(order):
                self._obeyed.append(order.id)
            if order.id not in known and bench is not None and order.kind == "forecast":
                answer = asyncio.create_task(self._forecasting.answer(order, bench.bench))
                self._answers.add(answer)
                answer.add_done_callback(self._answers.discard)
        return orders

    def _refuse(self, orders: AgentOrders) -> None:
        """Raises:
        BenchError: a bench is another's, and was from the beginning.
        """
        for name, bench in self._benches.items():
            why = orders.refused.get(name, "")
            if why and not self._heard:
                raise BenchError(why, where=name, fix="rename it in its file, or end the other one")
            if why and why != bench.refused:
                logger.warning("%s: %s", name, why)
            bench.refused = why

    def _first_answer(self, away: str) -> None:
        ready, self._request.ready = self._request.ready, lambda away: None
        ready(away)

    async def _take(self, bench: DrivenBench) -> None:
        if self._closing or bench.kept is not None or bench.bench.stopped() or bench.bench.used_by():
            return
        try:
            taken = (await self._service.ask(lambda client: client.take(self._id, bench.name))).run
        except (AwayError, RefusedError) as error:
            logger.warning("%s: no run was taken: %s", bench.name, error.what)
            return
        if taken is not None and not self._closing:
            await self._begin(bench, taken)

    async def _begin(self, bench: DrivenBench, taken: TakenRun) -> None:
        try:
            run = self._runs.begin(taken)
        except (HilError, OSError) as error:  # it is the same run that is given the next time
            logger.error("run %d cannot be started: %s", taken.data.id, error)
            return
        bench.kept = run
        try:
            bench.running = await RunExecution.begin(run.taken, bench.bench, run.folder)
        except (HilError, OSError) as error:
            code = error.exit_code if isinstance(error, HilError) else BenchError.exit_code
            end = _ending(RunEnd("ended", code, reason=str(error)))
            await _written(lambda: run.end(end))
        logger.info("run %d begins on %s", run.id, bench.name)
        self._see_through(run, bench)

    def _see_through(self, run: KeptRun, bench: DrivenBench | None) -> None:
        task = asyncio.create_task(self._seen_through(run, bench))
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _seen_through(self, run: KeptRun, bench: DrivenBench | None) -> None:
        """Be with a run until the service has it."""
        streaming = asyncio.create_task(self._deliveries.stream(run, lambda: run.ending is None))
        if run.ending is None:
            end = await self._ended(run, bench)
            logger.info("run %d ended with code %s: %s", run.id, end.exit_code, end.reason)
            await _written(lambda: run.end(_ending(end), end.at))
        if bench is not None:
            bench.running, bench.left = None, False
        await streaming
        refused = await self._deliveries.deliver(run)
        await _written(lambda: run.over(refused))
        if refused:
            logger.error("the service will not have run %d, it stays here: %s", run.id, refused)
        if bench is not None:
            bench.kept = None
        self._runs.clear()

    async def _ended(self, run: KeptRun, bench: DrivenBench | None) -> RunEnd:
        if bench is not None and bench.running is not None:
            return await bench.running.ended(bench.bench, lambda: None, lambda: self._closing)
        while alive_in(run.folder):
            await asyncio.sleep(_LOOK_S)
        return end_of_left(run.folder, "agent", bench.bench if bench is not None else None)


_URL_FIX = "check that this is the URL of a bench service of the same version"
_TOKEN_FIX = "set HIL_TOKEN to a token with the role agent: hil serve --data DIR --add-token NAME=agent"


async def _written(write: Callable[[], None]) -> None:
    """Write to the disk as soon as it takes it."""
    while True:
        try:
            write()
        except HilError as error:
            logger.error("cannot be kept, tried again: %s", error)
            await asyncio.sleep(_AGAIN_S)
        else:
            return


def _ending(end: RunEnd) -> RunEnding:
    code = None if end.exit_code is None else min(max(end.exit_code, 0), 255)
    return RunEnding(
        state=end.state,
        exit_code=code,
        reason=shortened(end.reason, _LONGEST_REASON),
        dut=shortened(end.dut, _LONGEST_DUT),
    )
