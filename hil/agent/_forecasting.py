"""Predicts plans for the service, where the bench is."""

from __future__ import annotations

import contextlib
import tempfile
from pathlib import Path

from hil.agent._service import AwayError, TheService
from hil.api_schemas.agent import AgentsForecast, Order, PlanSent
from hil.api_schemas.api import ForecastData, Problem
from hil.client import RefusedError
from hil.core.errors import BadInputError, BenchError, HilError
from hil.core.files import write_atomically
from hil.execution.benches import Bench
from hil.execution.forecasts import Forecasts
from test_plans import plan_from_text


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
