"""What a view asks about a run: under way from what is read of it anyway, afterwards by a worker."""

from __future__ import annotations

import asyncio
import contextlib
import functools
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hil.api_schemas.api import OVER, RunData
from hil.core.errors import BadInputError, BenchError, HilError
from hil.core.files.signatures import (
    SIGNATURE_SUFFIX,
    BrokenSignatureError,
    is_manifest,
    read_signature,
)
from hil.core.recording import Overview, read_overview
from hil.core.result import CriterionResult, RunResult
from hil.engine import RECORDING
from hil.service.live.live_hub import LiveView
from hil.service.worker_pool import run_view

if TYPE_CHECKING:
    from hil.service.service import Service

RESULT = "result.json"
_KEPT = 16  # overviews that stay open: their buckets stay in their files
_NOTHING: dict[str, Any] = {
    "first_s": 0.0,
    "last_s": 0.0,
    "sample_time_s": None,
    "channels": {},
    "marks": [],
    "limits": [],
    "criteria": [],
}
_READ: dict[str, Callable[..., dict[str, Any]]] = {
    "run_spectrum": run_view.spectrum_of,
    "run_samples": run_view.samples_of,
}


class RunViews:
    """Answers for the views of runs."""

    def __init__(self, service: Service) -> None:
        self._service = service

    async def view(self, run: RunData) -> dict[str, Any]:
        """Fields of `RunViewData`, but the run's number.

        Raises:
            BadInputError: nothing was recorded of it.
            BenchError: the disk does not keep what was read.
        """
        live = self._live(run)
        if live is not None:
            bench, overview = self._service.benches[run.bench], live.live.overview()
            criteria = [_criterion(one) for one in live.criteria]
            shown = run_view.shown(overview) if overview else _NOTHING | {"channels": bench.units}
            return shown | {"live": True, "limits": self._bench_limits(run.bench), "criteria": criteria}
        if run.state not in OVER:
            units = self._service.benches[run.bench].units if run.bench in self._service.benches else {}
            return _NOTHING | {"live": True, "channels": units}
        overview, _ = await self._kept(run)
        found = await asyncio.to_thread(run_view.shown, overview)
        result = await self._result(run)
        found |= {"live": False} | _of_result(result, found["marks"])
        if result is None:  # the bench's file as it was is in no result; today's is the best guess
            found["limits"] = self._bench_limits(run.bench)
        else:
            found["evidence"]["signed_by"] = ", ".join(await self._signers(run))
        return found

    async def _signers(self, run: RunData) -> list[str]:
        """Who signed the run's folder, as far as a signature is that of its manifest."""
        names = [name for name in self._service.files_of(run.id) if is_manifest(name)]
        found = []
        for name in names:
            manifest: Path = await self._service.file_of(run.id, name)
            await self._service.file_of(run.id, manifest.with_suffix(SIGNATURE_SUFFIX).name)
            with contextlib.suppress(BrokenSignatureError, HilError):
                signature = await asyncio.to_thread(read_signature, manifest)
                found += [signature.signed_by] if signature.intact else []
        return found

    async def traces(self, run: RunData, *, close: bool, **asked: Any) -> dict[str, Any]:
        """Fields of `RunTraces`, but the run's number.

        Args:
            close: whether samples may be needed one by one.

        Raises:
            BadInputError: as of `traces_of`.
        """
        live = self._live(run)
        found = (_begun(live), live.live.path) if live is not None else await self._kept(run, close=close)
        return await asyncio.to_thread(run_view.traces_of, *found, **asked)

    async def ask(self, task: str, run: RunData, **asked: Any) -> dict[str, Any]:
        """An answer of the worker's tasks `run_spectrum` or `run_samples`.

        Raises:
            BadInputError: it cannot be answered.
        """
        live = self._live(run)
        if live is not None:
            return await asyncio.to_thread(_READ[task], _begun(live), live.live.path, **asked)
        return await self._service.viewing.ask(task, **await self._files(run, close=True), **asked)

    def _bench_limits(self, name: str) -> list[dict[str, Any]]:
        """The largest magnitudes that the bench allows now; none of a bench that is not here."""
        bench = self._service.benches.get(name)
        limits = bench.limits.items() if bench else ()
        return [{"channel": channel, "above": most, "below": -most} for channel, most in limits]

    def _live(self, run: RunData) -> LiveView | None:
        """The run as it is followed; None if it is over, and what it left is looked at."""
        shown = self._service.live_hub.run_of(run.bench)
        return shown if shown is not None and shown.run == run.id and run.state not in OVER else None

    async def _kept(self, run: RunData, *, close: bool = False) -> tuple[Overview, Path]:
        """The overview of a run that is over, made if it is not there, and the place of its recording."""
        files = await self._files(run, close=close)
        folder = Path(files["folder"])
        overview = await asyncio.to_thread(_opened, folder)
        if overview is None:
            _opened.cache_clear()
            await self._service.viewing.ask("run_overview", **files)
            overview = await asyncio.to_thread(_opened, folder)
        if overview is None:
            raise BenchError("what was read of the recording cannot be kept", where=files["folder"])
        return overview, Path(files["recording"])

    async def _files(self, run: RunData, *, close: bool = False) -> dict[str, str]:
        """Where its overview is kept, and its recording, which is brought back where it is needed."""
        service = self._service
        folder, here = service.live_hub.overview_folder(run.id), service.queue.folder_of(run.id) / RECORDING
        if run.state not in OVER or RECORDING not in service.files_of(run.id):
            raise BadInputError("nothing was recorded", where=f"run {run.id}")
        if not here.is_file() and (close or not folder.is_dir()):
            here = await service.file_of(run.id, RECORDING)
        return {"folder": str(folder.resolve()), "recording": str(here.resolve())}

    async def _result(self, run: RunData) -> RunResult | None:
        if RESULT not in self._service.files_of(run.id):
            return None
        path: Path = await self._service.file_of(run.id, RESULT)
        try:
            return RunResult.model_validate_json(path.read_bytes())
        except (OSError, ValueError):
            return None


@functools.lru_cache(_KEPT)
def _opened(folder: Path) -> Overview | None:
    return read_overview(folder)


def _begun(live: LiveView) -> Overview:
    overview = live.live.overview()
    if overview is None:
        raise BadInputError("nothing has been measured yet", where=f"run {live.run}")
    return overview


def _criterion(one: CriterionResult) -> dict[str, Any]:
    return one.model_dump(mode="json", exclude={"definition"}) | {"margin": one.margin}


def _of_result(result: RunResult | None, marks: list[dict[str, Any]]) -> dict[str, Any]:
    """What the run's result adds to its recording."""
    if result is None:
        return {"limits": [], "criteria": [], "evidence": {"whole": False}}
    marks += [
        {"kind": "hold", "name": "held", "text": one.cause, "start_s": one.start_s, "end_s": one.end_s}
        for one in result.holds
    ]
    fields = {"channel", "below", "above", "response", "reached"}
    lines = [one.model_dump(include=fields) for one in result.limits if one.of == "value"]
    evidence = {"samples_sha256": result.samples_sha256, "files": result.sha256, "whole": True}
    return {
        "limits": [*lines, *_of_both_sides(lines)],
        "criteria": [_criterion(one) for one in result.criteria],
        "evidence": evidence,
    }


def _of_both_sides(lines: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The limit of the whole shaft torque, of which each side may have half."""
    sides = {line["channel"]: line for line in lines}
    left, right = (sides.get(f"shaft_torque_{side}_nm") for side in ("left", "right"))
    one = left or right
    if one is None or "shaft_torque_nm" in sides or one["above"] is None or one["below"] is None:
        return []
    return [
        one
        | {"channel": "shaft_torque_nm", "above": 2 * one["above"], "below": 2 * one["below"], "reached": 0}
    ]
