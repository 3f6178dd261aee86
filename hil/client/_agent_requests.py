"""What agents tell and take."""

from __future__ import annotations

from hil.api_schemas.agent import (
    AgentData,
    AgentOrders,
    AgentReport,
    AgentsForecast,
    Delivered,
    FileThere,
    RunEnding,
    Taken,
)
from hil.client._requests import WITHIN_S, Requests, part

_FORECAST_WITHIN_S = 300.0
_REPORTED_WITHIN_S = 5.0


class AgentRequests(Requests):
    """What agents tell and take."""

    def agents(self) -> list[AgentData]:
        """Agents that have benches there."""
        return self._several(AgentData, "/agents")

    def let_agent_go(self, bench: str) -> None:
        """Let another agent have the bench of one that is away."""
        self._done("DELETE", f"/benches/{part(bench)}/agent")

    def report(self, agent: str, report: AgentReport) -> AgentOrders:
        """What an agent tells of itself, and what it has to do."""
        return self._one(AgentOrders, "PUT", f"/agents/{agent}", report, within_s=_REPORTED_WITHIN_S)

    def take(self, agent: str, bench: str) -> Taken:
        """The run whose turn it is on a bench of an agent."""
        return self._one(Taken, "POST", f"/agents/{agent}/benches/{part(bench)}/take")

    def send(self, agent: str, run: int, name: str, at: int, piece: bytes) -> FileThere:
        """A piece of a file of an agent's run; how much of it is there then."""
        return self._one(FileThere, "PUT", f"/agents/{agent}/runs/{run}/files/{part(name)}?at={at}", piece)

    def answer_forecast(self, agent: str, order: str, answer: AgentsForecast) -> None:
        """What an agent predicts of a plan that it was asked about."""
        with self._opened("PUT", f"/agents/{agent}/forecasts/{order}", answer, WITHIN_S):
            pass

    def deliver(self, agent: str, run: int, ending: RunEnding) -> Delivered:
        """How an agent's run ended; which of its files are to be sent before it is over there."""
        return self._one(
            Delivered, "POST", f"/agents/{agent}/runs/{run}/ending", ending, within_s=_FORECAST_WITHIN_S
        )
