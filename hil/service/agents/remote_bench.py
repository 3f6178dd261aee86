"""A bench of an agent on another machine: what it is, what its agent reported last, what that has to do."""

from __future__ import annotations

import asyncio
import datetime
import secrets
import time
from dataclasses import dataclass, field

from hil.api_schemas.agent import AgentBench, Order, OrderKind, PlanSent
from hil.api_schemas.api import BenchState
from hil.core.errors import StopWay
from hil.engine.ipc.ipc_messages import EmergencyAsked
from hil.execution.run_execution import RunningRun
from hil.service.store import BenchStore

AWAY_S = 10.0
_LATE_S = 3.0
_SAFER: tuple[OrderKind, ...] = ("pause", "end", "emergency_stop", "forecast")


@dataclass
class Agent:
    """An agent. `held`: benches in the database, as a service of its own has them."""

    id: str
    name: str
    machine: str
    version: str
    heard_at: datetime.datetime
    held: BenchStore
    heard_s: float = -1e9
    orders: dict[str, Order] = field(default_factory=dict)
    news: asyncio.Event = field(default_factory=asyncio.Event)

    @property
    def away(self) -> bool:
        """Whether it has not been heard of for so long that nothing is known of it now."""
        return time.monotonic() - self.heard_s > AWAY_S

    def drop_what_came_late(self) -> None:
        """Before it is heard: what would let something move is not meant any more once it was silent."""
        if time.monotonic() - self.heard_s > _LATE_S:
            self.orders = {name: one for name, one in self.orders.items() if one.kind in _SAFER}


class RemoteBench:
    """A bench of an agent: what it is, and what its agent reported last."""

    def __init__(self, agent: Agent, report: AgentBench) -> None:
        self.agent, self.report = agent, report
        self.running: RunningRun | None = None
        self.stop_by = ""  # of an emergency stop that the agent has not confirmed
        self.kept_s = -1e9
        self.was_away = True

    @property
    def name(self) -> str:
        """As it is called in its file."""
        return self.report.name

    @property
    def title(self) -> str:
        """What it is called for people."""
        return self.report.title

    @property
    def simulated(self) -> bool:
        """Whether what moves is computed."""
        return self.report.simulated

    @property
    def limits(self) -> dict[str, float]:
        """Largest magnitude by channel."""
        return self.report.limits

    @property
    def units(self) -> dict[str, str]:
        """Units of the limited channels."""
        return self.report.units

    def order(
        self,
        kind: OrderKind,
        by: str = "",
        text: str = "",
        plan: PlanSent | None = None,
        *,
        origin: str = "",
        way: StopWay = "",
    ) -> Order:
        """Notify the agent."""
        of_run = kind not in ("reset", "forecast")
        order = Order(
            id=secrets.token_hex(8),
            bench=self.name,
            kind=kind,
            run=self.running.data.id if self.running is not None and of_run else None,
            by=by,
            origin=origin,
            way=way,
            text=text,
            plan=plan,
        )
        self.agent.orders[order.id] = order
        self.agent.news.set()
        return order

    def stops(self) -> set[str]:
        """Orders of an emergency stop that its agent has not obeyed."""
        return {
            one.id
            for one in self.agent.orders.values()
            if one.kind == "emergency_stop" and one.bench == self.name
        }

    def state(self) -> tuple[BenchState, str]:
        """What it does, as far as is known."""
        agent = self.agent
        since = f"{agent.heard_at:%Y-%m-%d %H:%M:%S} UTC"
        away = (
            f"its agent {agent.name} on {agent.machine} is not connected since {since}" if agent.away else ""
        )
        if self.stop_by:
            unconfirmed = f"requested by {self.stop_by}; its agent has not confirmed it"
            return "emergency_stop", f"{unconfirmed}; {away}" if away else unconfirmed
        if away:
            if self.running is not None:
                away += f"; run {self.running.data.id} ends there by itself; its agent uploads it later"
            return "away", away
        if self.report.state == "free" and self.running is not None:
            return "running", self.running.shown
        return self.report.state, self.report.why


class AgentsRun:
    """Steers a run by orders to its agent."""

    def __init__(self, bench: RemoteBench) -> None:
        self._bench = bench

    def pause(self) -> None:
        """Hold it at its next safe point."""
        self._bench.order("pause")

    def resume(self) -> None:
        """Let it go on."""
        self._bench.order("resume")

    def end(self) -> None:
        """End it, with its end steps."""
        self._bench.order("end")

    def stop_in_emergency(self, asked: EmergencyAsked) -> None:
        """Nothing: the bench's order says it, whether there is a run or not."""

    def answer(self, text: str) -> None:
        """A line for the operator's prompt."""
        self._bench.order("answer", text=text)
