"""Campaigns of the service, resumed after any end.

A campaign's folder has a copy of every file that it names (`given/`). One that was under way when the service
ended, or was killed, waits again when the next one begins, and simulates what is missing.
"""

from __future__ import annotations

import asyncio
import contextlib
import datetime
import json
import logging
import shutil
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from hil.api_schemas.campaign import (
    SUMMARY,
    TABLE,
    CampaignData,
    CampaignExample,
    CampaignWanted,
    PassedShare,
)
from hil.app.requests import CampaignRequest
from hil.core.errors import BenchError, HilError
from hil.core.files import make_directory
from hil.core.files.locks import HeldError, lock_on
from hil.service.jobs.job_repository import kill_left
from hil.service.jobs.jobs import Jobs
from hil.service.jobs.shared_results import SharedResults
from hil.service.plain_words import in_plain_words
from hil.service.worker_pool import WorkerPool

_LOOK_S = 1.0
_FREE_WITHIN_S = 30.0  # processes of a killed one end by themselves
_LAST_WORDS_S = 5.0
_GIVEN = "given"
_INTERRUPTED = 130

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Simulating:
    """Who simulates: processes of this machine, or the workers of a dask scheduler."""

    workers: int | None = None
    scheduler: str = ""


@dataclass(frozen=True)
class Places:
    """What a campaign may name: the folder of plans and controllers, models and benches by name."""

    plans: Path
    models: Mapping[str, Path]
    benches: Mapping[str, Path]


@dataclass
class _Pace:
    """Of one under way: when and with how many it began, and how far it is now."""

    began: tuple[float, int] | None = None
    changes: dict[str, Any] = field(default_factory=dict)


class Campaigns(Jobs[CampaignData]):
    """All of them, by number.

    Args:
        folder: where each has a folder of its own.
        simulating: who simulates.
        worker_pool: reads campaigns and their tables.
        shared: those of other services.
    """

    def __init__(
        self,
        folder: Path,
        simulating: Simulating,
        worker_pool: WorkerPool,
        shared: SharedResults[CampaignData],
    ) -> None:
        super().__init__(folder, "state.json", CampaignData, shared, "campaign", "campaigns")
        self._simulating, self._worker_pool = simulating, worker_pool
        self._paces: dict[int, _Pace] = {}

    def go_on(self) -> None:
        """Resume what was under way when the service before this one ended, oldest first."""
        for campaign in reversed(list(self._records)):
            if self.is_over(campaign):
                continue
            kill_left(self._records.folder_of(campaign.id))
            stopped = campaign.state == "stopping"
            state = "cancelled" if stopped else "waiting"
            self._records.change(campaign.id, state=state, reason="cancelled" if stopped else "")
            if not stopped:
                self._begin(campaign.id, self._execute(campaign.id))

    async def examples(self) -> list[CampaignExample]:
        """The built-in ones."""
        found = await self._worker_pool.ask("campaign_examples")
        return [CampaignExample(**one) for one in found["examples"]]

    async def add(self, wanted: CampaignWanted, places: Places, by: str) -> CampaignData:
        """Have one executed in its turn.

        Raises:
            BadInputError: something is wrong with it, or too many wait already.
        """
        self._refuse_too_many()
        number = self._records.take_number()
        folder = self._records.folder_of(number)
        try:
            found = await self._worker_pool.ask(
                "campaign",
                text=wanted.text,
                files=wanted.files,
                folder=str((folder / _GIVEN).resolve()),
                plans=str(places.plans.resolve()),
                models={name: str(path.resolve()) for name, path in places.models.items()},
                benches={name: str(path.resolve()) for name, path in places.benches.items()},
            )
        except BaseException:
            shutil.rmtree(folder, ignore_errors=True)
            raise
        campaign = CampaignData(
            id=number,
            state="waiting",
            requested_by=by,
            asked_at=datetime.datetime.now(datetime.UTC),
            digest=wanted.digest,
            **found,
        )
        self._records.keep(campaign)
        self._begin(number, self._execute(number))
        return campaign

    def given(self, number: int) -> Path:
        """Where the files are that one of this service was made from."""
        return self._records.folder_of(number) / _GIVEN

    async def cancel(self, number: int) -> bool:
        """End one: what is under way is awaited and kept; asked twice, it is not. False if it is over."""
        process = self._processes.get(number)
        if process is None:
            cancelled = await super().cancel(number)
            found = self._records.get(number)
            if cancelled and found is not None and not self.is_over(found):  # it had not started
                self._end(number, _INTERRUPTED)
            return cancelled
        self._records.change(number, state="stopping")
        process.interrupt()
        return True

    def resume(self, number: int) -> bool:
        """Go on with one that was cancelled or has failed; False if it is in another state.

        Raises:
            BadInputError: too many wait already.
        """
        found = self._records.get(number)
        if found is None or found.state not in ("cancelled", "failed") or number in self._tasks:
            return False
        self._refuse_too_many()
        self._records.change(number, state="waiting", reason="", ended_at=None)
        self._begin(number, self._execute(number))
        return True

    async def _execute(self, number: int) -> None:
        pace = self._paces[number] = _Pace()
        try:
            make_directory(self.results(number))
            await self._free(number)
            self._records.change(number, state="running")
            code, reason = await self._simulate(number, pace)
            await self._look(number, pace)
            await self._write_table(number)
            self._end(number, code, reason, pace.changes)
        except asyncio.CancelledError:
            self._end(number, _INTERRUPTED)
            raise
        except (HilError, OSError) as error:
            self._end(number, HilError.exit_code, str(error))
        finally:
            self._paces.pop(number, None)

    async def _free(self, number: int) -> None:
        """Wait until no one writes there: processes that a killed service has left may still be ending.

        Raises:
            BenchError: somebody still does.
        """
        until_s = time.monotonic() + _FREE_WITHIN_S
        while True:
            try:
                with lock_on(self.results(number)):
                    return
            except HeldError as error:
                if time.monotonic() > until_s:
                    raise BenchError(f"its folder is in use: {error}", fix="end that process") from error
            await asyncio.sleep(_LOOK_S)

    async def _simulate(self, number: int, pace: _Pace) -> tuple[int, str]:
        """Exit code, and why it failed."""
        request = CampaignRequest(
            campaign=str((self._records.folder_of(number) / _GIVEN / "campaign.yaml").resolve()),
            workers=self._simulating.workers,
            scheduler=self._simulating.scheduler,
            resume=True,
            out=self.results(number).resolve(),
        )
        async with self._process(number, request, _LAST_WORDS_S) as process:
            over = asyncio.ensure_future(process.over())
            try:
                while not over.done():
                    await self._look(number, pace)
                    await asyncio.wait([over], timeout=_LOOK_S)
                return over.result()
            finally:
                over.cancel()

    async def _write_table(self, number: int) -> None:
        try:
            await self._worker_pool.ask(
                "campaign_table", folder=self._at(number), file=self._at(number, TABLE)
            )
        except HilError as error:
            logger.warning("campaign %d has its table in parts only: %s", number, error)

    async def _look(self, number: int, pace: _Pace) -> None:
        """What is on disk by now, and how many a second came since it began."""
        try:
            found = await self._worker_pool.ask("campaign_so_far", folder=self._at(number))
        except HilError as error:
            logger.warning("campaign %d: %s", number, error)
            return
        now_s, done = time.monotonic(), found["done"]
        pace.began = pace.began or (now_s, done)
        rate_hz = (done - pace.began[1]) / max(now_s - pace.began[0], _LOOK_S)
        shares = [PassedShare(**one) for one in found["controllers"]]
        campaign = self._records.get(number)
        if campaign is not None and campaign.draws == 0:  # chosen values are no sample
            shares = [share.model_copy(update={"interval": None}) for share in shares]
        pace.changes = {"done": done, "rate_hz": rate_hz, "controllers": shares}

    def _end(
        self, number: int, code: int, reason: str = "", progress: Mapping[str, Any] | None = None
    ) -> None:
        changes = {**(progress or {}), "rate_hz": 0.0}
        if code in (0, 1):
            changes |= {"state": "ended", "reason": "", "passed": self._passed(number)}
        elif code == _INTERRUPTED:
            changes |= {"state": "cancelled", "reason": "cancelled"}
        else:
            changes |= {"state": "failed", "reason": in_plain_words(reason, {})}
        self._change(number, **changes)

    def _passed(self, number: int) -> bool | None:
        with contextlib.suppress(OSError, ValueError):
            found = json.loads((self.results(number) / SUMMARY).read_bytes())["passed"]
            return found if isinstance(found, bool) else None
        return None

    def _progress(self, number: int) -> dict[str, Any]:
        pace = self._paces.get(number)
        return {} if pace is None else pace.changes

    def _at(self, number: int, name: str = "") -> str:
        return str((self.results(number) / name).resolve())
