"""What agents predict of plans on their benches: `hil check`, executed where the bench is."""

from __future__ import annotations

import asyncio

from hil.api_schemas.agent import AgentsForecast
from hil.api_schemas.api import ForecastData, Problem
from hil.core.errors import BadInputError, BenchError
from hil.service.agents.agents import sent
from hil.service.agents.remote_bench import RemoteBench
from test_plans import Plan

_WITHIN_S = 200.0


class AgentsForecasts:
    """Forecasts that are asked for, each until its agent has answered."""

    def __init__(self) -> None:
        self._asked: dict[str, asyncio.Future[AgentsForecast]] = {}

    async def of(self, plan: Plan, bench: RemoteBench) -> ForecastData:
        """Duration, peaks and criteria.

        Raises:
            BadInputError: the plan asks for more than the bench allows.
            BenchError: the agent is away, or cannot predict it.
        """
        if bench.agent.away:
            raise BenchError(
                bench.state()[1], where="forecast", fix="the run can be queued without a forecast"
            )
        order = bench.order("forecast", plan=sent(plan))
        self._asked[order.id] = asyncio.get_running_loop().create_future()
        try:
            answer = await asyncio.wait_for(self._asked[order.id], _WITHIN_S)
        except TimeoutError:
            raise BenchError("its agent has not sent a forecast", where="forecast") from None
        finally:
            del self._asked[order.id]
            bench.agent.orders.pop(order.id, None)
        if answer.forecast is not None:
            return answer.forecast
        problem = answer.problem or Problem(what="the agent gives no reason")
        kind = BadInputError if answer.refused else BenchError
        raise kind(problem.what, where=problem.where, fix=problem.fix)

    def answer(self, order: str, answer: AgentsForecast) -> bool:
        """Take an agent's answer; false if no one waits for it."""
        asked = self._asked.get(order)
        if asked is None or asked.done():
            return False
        asked.set_result(answer)
        return True
