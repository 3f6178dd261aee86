"""What is known of a run beforehand: a check in a process of its own, so that nothing waits for it."""

from __future__ import annotations

import asyncio
import json
import tempfile
from collections import OrderedDict
from pathlib import Path

from hil.api_schemas.api import ForecastData
from hil.app.requests import CheckRequest
from hil.app.worker.job import JOB, write_request
from hil.core.errors import BadInputError, BenchError
from hil.core.files import read_bytes
from hil.engine import BenchFile
from hil.execution.background import FORECAST_BYTES, output_of, start_process
from hil.execution.data_folder import files_of
from test_plans import Plan

_AT_ONCE = 1  # a run needs the other processor
_WITHIN_S = 180.0
_KEPT = 100
_NICENESS = 10


class Forecasts:
    """Forecasts by plan and bench; the newest ones are kept."""

    def __init__(self) -> None:
        self._turn = asyncio.Semaphore(_AT_ONCE)
        self._known: OrderedDict[tuple[str, str], ForecastData] = OrderedDict()

    async def of(self, plan: Plan, bench: BenchFile) -> ForecastData:
        """Duration, peaks and criteria.

        Raises:
            BadInputError: the plan asks for more than the bench allows.
            BenchError: it cannot be predicted.
        """
        key = plan.text, bench.text
        if key not in self._known:
            async with self._turn:
                if key not in self._known:
                    self._known[key] = await self._made(plan, bench)
        self._known.move_to_end(key)
        while len(self._known) > _KEPT:
            self._known.popitem(last=False)
        return self._known[key]

    async def _made(self, plan: Plan, bench: BenchFile) -> ForecastData:
        with tempfile.TemporaryDirectory(prefix="hil-forecast-") as folder:
            file = Path(folder) / "plan.yaml"
            file.write_text(plan.text, "utf-8")
            for loaded in files_of(plan):  # the service's controllers lie beside its plans
                if loaded.parent == plan.source.parent:
                    (file.parent / loaded.name).write_bytes(read_bytes(loaded))
            write_request(file.parent, CheckRequest(plan=str(file), bench=str(bench.source)))
            code, out, complaint = await self._execute(file.parent)
        if code in (0, 1):
            found = json.loads(out)
            return ForecastData.model_validate({name: found[name] for name in ForecastData.model_fields})
        what = complaint.removeprefix("error: ").strip().replace(str(file), plan.name)
        kind = BadInputError if code == BadInputError.exit_code else BenchError
        raise kind(what or "the forecast was ended", where="forecast")

    async def _execute(self, folder: Path) -> tuple[int, bytes, str]:
        process = await start_process(
            *JOB,
            str(folder),
            niceness=_NICENESS,
            most_bytes=FORECAST_BYTES,
            stdin=asyncio.subprocess.DEVNULL,
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.PIPE,
        )
        try:
            out, complaint = await output_of(process, _WITHIN_S)
        except TimeoutError as error:
            raise BenchError(f"took more than {_WITHIN_S:g} s", where="forecast") from error
        return process.returncode or 0, out, complaint.decode("utf-8", "replace")
