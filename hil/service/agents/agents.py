"""Benches of agents on other machines, as the service knows them (docs/decisions/0024).

An agent asks, the service answers: it tells what its benches do twice a second and hears what to do. What is
known here of a run is what its agent reported last; a run stays its agent's, however long it is away.
"""

from __future__ import annotations

import asyncio
import contextlib
import datetime
import logging
import time
from collections.abc import Callable
from pathlib import Path

from sqlalchemy import Engine

from hil.api_schemas.agent import AgentBench, AgentData, AgentOrders, AgentReport, PlanSent, TakenRun
from hil.core.errors import HilError
from hil.core.files import make_directory, read_text, write_atomically
from hil.engine.ipc.ipc_messages import EmergencyAsked
from hil.execution.data_folder import files_of, folder_of
from hil.execution.run_execution import PLAN, RunningRun
from hil.service.agents.remote_bench import Agent, AgentsRun, RemoteBench
from hil.service.store import AgentStore, BenchStore, DatabaseAwayError, RunStore
from hil.service.turns import Turns
from test_plans import Plan, plan_from_text

_KEPT_AGAIN_S = 20.0  # a third of how long a bench is an agent's without being heard of
_SETTLED_S = 5.0

logger = logging.getLogger(__name__)


class Agents:
    """All benches of agents.

    Args:
        service: the name of this one in the database.
        turns: whose turn it is on a bench.
        folder: where runs have their folders.
        source: where a plan lies here by its name, with what it loads beside it.
        changed: called whenever something of a bench is to be shown anew.
    """

    def __init__(
        self,
        engine: Engine,
        service: str,
        runs: RunStore,
        turns: Turns,
        folder: Path,
        source: Callable[[str], Path],
        changed: Callable[[str], None],
    ) -> None:
        self._engine, self._runs, self._turns, self._folder = engine, runs, turns, folder
        self._source = source
        self._store = AgentStore(engine, service)
        self._changed = changed
        self.benches: dict[str, RemoteBench] = {}
        self._agents: dict[str, Agent] = {}
        for row in self._store.all():
            agent = self._agent(row.agent, row.name, row.machine, row.version, row.heard_at)
            bench = self.benches[row.bench.name] = RemoteBench(agent, row.bench)
            self._restore(bench)
            if row.stop_by:
                self._stop(bench, EmergencyAsked(by=row.stop_by))

    def all(self) -> list[AgentData]:
        """Those that have benches here."""
        found = []
        for agent in self._agents.values():
            names = [name for name, bench in self.benches.items() if bench.agent is agent]
            if names:
                found.append(
                    AgentData(
                        name=agent.name,
                        machine=agent.machine,
                        version=agent.version,
                        benches=names,
                        connected=not agent.away,
                        heard_at=agent.heard_at,
                    )
                )
        return found

    def running_run(self, run: int) -> RunningRun | None:
        """A run by its number, if one of theirs is under way."""
        found = (bench.running for bench in self.benches.values())
        return next((one for one in found if one is not None and one.data.id == run), None)

    def look(self) -> None:
        """Have it shown which agents are away, and whose runs have come to another service meanwhile."""
        for bench in list(self.benches.values()):
            running = bench.running
            if bench.agent.away and running is not None:
                with contextlib.suppress(DatabaseAwayError):
                    run = self._runs.get(running.data.id)
                    if run is None or run.state != "running":
                        self.over(running.data.id, bench.name)
            if bench.agent.away != bench.was_away:
                bench.was_away = bench.agent.away
                (logger.warning if bench.was_away else logger.info)(
                    "%s: its agent is %s", bench.name, "away" if bench.was_away else "there"
                )
                self._changed(bench.name)

    def heard(self, agent_id: str, report: AgentReport) -> tuple[list[str], dict[str, str]]:
        """Take what an agent tells.

        Returns:
            its benches that were registered just now, and those that are not its own, with the reason.

        Raises:
            DatabaseAwayError: no one can tell whose the benches are.
        """
        agent = self._agent(agent_id, report.name, report.machine, report.version)
        agent.name, agent.machine, agent.version = report.name, report.machine, report.version
        agent.drop_what_came_late()
        agent.heard_s, agent.heard_at = time.monotonic(), _now()
        new, refused = [], {}
        for one in report.benches:
            known = self.benches.get(one.name)
            if known is None or known.agent is not agent:
                why = self._register(agent, one)
                if why:
                    refused[one.name] = why
                else:
                    new.append(one.name)
            if one.name not in refused:
                why = self._take_in(self.benches[one.name], one, report.obeyed)
                if why:
                    refused[one.name] = why
        for order in report.obeyed:
            agent.orders.pop(order, None)
        if report.leaving:
            self._leave(agent)
        self.look()
        return new, refused

    def orders(self, agent_id: str, refused: dict[str, str]) -> AgentOrders:
        """What an agent has to do."""
        agent = self._agents[agent_id]
        mine = [one for one in self.benches.values() if one.agent is agent]
        waiting: list[str] = []
        with contextlib.suppress(DatabaseAwayError):  # nothing is started until it answers
            waiting = [one.name for one in mine if self._may_take(one) and self._next(one) is not None]
        return AgentOrders(orders=list(agent.orders.values()), waiting=waiting, refused=refused)

    async def wait_for_orders(self, agent_id: str, within_s: float) -> None:
        """Wait until there is something new for an agent to do."""
        agent = self._agents[agent_id]
        agent.news.clear()
        with contextlib.suppress(TimeoutError):
            await asyncio.wait_for(agent.news.wait(), within_s)

    def wake(self, bench: str) -> None:
        """Notify a bench's agent of what waits for it."""
        if bench in self.benches:
            self.benches[bench].agent.news.set()

    def take(self, agent_id: str, name: str) -> TakenRun | None:
        """Give an agent the run whose turn it is; one that it was given, and has nothing of, once more.

        Raises:
            HilError: what the run needs cannot be read; it has ended by that.
            DatabaseAwayError: nothing is started now.
        """
        bench = self.benches[name]
        given = [one.id for one in self._runs.running(agent_id) if one.bench == name]
        taken = None
        if given:
            taken = self._runs.taken(given[0])
        elif self._may_take(bench) and (run := self._next(bench)) is not None:
            taken = self._runs.take(run, agent_id)
        if taken is None:
            bench.kept_s = -1e9  # it is looked at once more whose the bench is
            return None
        folder = folder_of(self._folder, taken.data.id)
        try:
            source = self._source(taken.data.plan)
            plan = sent(plan_from_text(taken.plan_text, str(source), source.parent))
            make_directory(folder)
            write_atomically(folder / PLAN, taken.plan_text)
        except DatabaseAwayError:  # the agent is given it once more
            raise
        except HilError as error:
            self._runs.end(taken.data.id, "ended", exit_code=error.exit_code, reason=str(error))
            self._changed(name)
            raise
        bench.running = RunningRun(taken.data, folder, AgentsRun(bench))
        self._changed(name)
        return taken.model_copy(update={"files": plan.files, "plan_source": plan.source})

    def over(self, run: int, bench: str) -> None:
        """A run has been written down as over."""
        place = self.benches.get(bench)
        if place is not None and place.running is not None and place.running.data.id == run:
            place.running = None
        self._changed(bench)

    def stop_in_emergency(self, bench: str, asked: EmergencyAsked) -> None:
        """Have a bench safe and latched as soon as its agent hears it; asks no database."""
        self._stop(self.benches[bench], asked)
        self._changed(bench)

    def remember_stop(self, bench: str, asked: EmergencyAsked) -> None:
        """Have the next service notify the agent, too.

        Raises:
            DatabaseAwayError: only as long as this service lives.
        """
        self._store.stop(bench, asked.by)

    async def reset(self, bench: str, by: str) -> bool:
        """Let a bench be armed again; whether its agent has done so within a few seconds."""
        place = self.benches[bench]
        if place.agent.away:
            return False
        order = place.order("reset", by)
        until_s = time.monotonic() + _SETTLED_S
        while order.id in place.agent.orders and time.monotonic() < until_s:
            await asyncio.sleep(0.05)
        return place.agent.orders.pop(order.id, None) is None  # no one expects it any more, later

    def let_go(self, bench: str, by: str) -> None:
        """Let another agent have the bench of one that is away; a run that it has is interrupted.

        An emergency stop that no one has confirmed is shown to whoever has the bench next.
        """
        place = self.benches[bench]
        why = f"{by} has let the bench of an agent go that was away; what it has comes when it is back"
        for run in self._runs.running(place.agent.id):
            if run.bench == bench:
                self._runs.end(run.id, "interrupted", reason=why)
        place.agent.held.give_back(bench)
        place.running = None
        if not place.stop_by:
            self._store.forget(bench)
        self._changed(bench)

    def _agent(
        self, agent: str, name: str, machine: str, version: str, heard_at: datetime.datetime | None = None
    ) -> Agent:
        if agent not in self._agents:
            held = BenchStore(self._engine, agent, f"agent {name} on {machine}")
            self._agents[agent] = Agent(agent, name, machine, version, heard_at or _now(), held)
        return self._agents[agent]

    def _register(self, agent: Agent, report: AgentBench) -> str:
        """Have a bench as an agent's; why not, if it is somebody else's."""
        there = agent.held.hold(report.name)
        if there:
            return _of_another(report.name, there)
        before = self.benches.get(report.name)
        bench = self.benches[report.name] = RemoteBench(agent, report)
        if before is not None and before.stop_by:
            self._stop(bench, EmergencyAsked(by=before.stop_by))
        self._restore(bench)
        return ""

    def _restore(self, bench: RemoteBench) -> None:
        """A run that the agent has started, as is written."""
        for run in self._runs.running(bench.agent.id):
            if run.bench == bench.name:
                folder = folder_of(self._folder, run.id)
                bench.running = RunningRun(run, folder, AgentsRun(bench), doing="its agent is not connected")

    def _take_in(self, bench: RemoteBench, report: AgentBench, obeyed: list[str]) -> str:
        """Take what an agent tells of a bench; why it is not the agent's any more, if that is so."""
        before, there = (bench.report, bench.stop_by), ""
        bench.report = report
        with contextlib.suppress(DatabaseAwayError):
            there = self._keep(bench)
            if report.running is not None and (
                bench.running is None or bench.running.data.id != report.running
            ):
                self._restore(bench)
        if bench.running is not None and bench.running.data.id == report.running:
            bench.running.share, bench.running.doing = report.share, report.doing
            bench.running.message, bench.running.prompt = report.message, report.prompt
        if bench.stop_by and bench.stops() <= set(obeyed):
            bench.stop_by = ""
            with contextlib.suppress(DatabaseAwayError):
                self._store.stop(bench.name, "")
        if before != (bench.report, bench.stop_by):
            self._changed(bench.name)
        return _of_another(bench.name, there) if there else ""

    def _keep(self, bench: RemoteBench) -> str:
        """Go on having the bench as its agent's, in the database; whose it is, if that is somebody else."""
        agent, there = bench.agent, ""
        if time.monotonic() - bench.kept_s > _KEPT_AGAIN_S:
            there = agent.held.hold(bench.name)
            if not there:
                self._store.heard(agent.id, agent.name, agent.machine, agent.version, bench.report)
                bench.kept_s = time.monotonic()
        return there

    def _stop(self, bench: RemoteBench, asked: EmergencyAsked) -> None:
        """One order that no one has obeyed yet says it: who asks again adds none."""
        if bench.stop_by and bench.stops():
            bench.agent.news.set()
            return
        bench.stop_by = asked.by
        bench.order("emergency_stop", asked.by, origin=asked.origin, way=asked.way)

    def _leave(self, agent: Agent) -> None:
        agent.heard_s = -1e9
        for bench in list(self.benches.values()):
            if bench.agent is agent and bench.running is None:
                agent.held.give_back(bench.name)

    def _may_take(self, bench: RemoteBench) -> bool:
        return bench.report.state == "free" and not bench.stop_by and bench.report.running is None

    def _next(self, bench: RemoteBench) -> int | None:
        """The run whose turn it is; None while there is one that the agent has not delivered."""
        if bench.running is not None:
            return bench.running.data.id if bench.report.running is None else None
        run = self._turns.next_of(bench.name)
        return None if run is None else run.id


def sent(plan: Plan) -> PlanSent:
    """A plan with the files that lie beside it and are loaded by it; built-in ones are there.

    Raises:
        BadInputError: one of them cannot be read.
    """
    folder = plan.source.parent
    files = {file.name: read_text(file) for file in files_of(plan) if file.parent == folder}
    return PlanSent(text=plan.text, source=plan.source.name, files=files)


def _of_another(bench: str, place: str) -> str:
    return f"the name '{bench}' is that of a bench of {place}"


def _now() -> datetime.datetime:
    return datetime.datetime.now(datetime.UTC)
