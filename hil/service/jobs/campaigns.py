"""Campaigns of the service: `hil campaign` in a process of its own, gone on with after any end.

Each has a folder: what was asked (`given/`, a copy of every file that it names), how it stands
(`state.json`) and what comes of it (`results/`). A campaign that was under way when the service ended, or was
killed, waits again when the next one begins, and simulates what is missing.
"""

from __future__ import annotations

import asyncio
import contextlib
import datetime
import json
import logging
import shutil
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from hil.core.errors import BadInputError, BenchError, HilError
from hil.core.files import make_directory
from hil.core.locks import HeldError, lock_on
from hil.messages.campaign import (
    CAMPAIGN_OVER,
    TABLE,
    CampaignData,
    CampaignExample,
    CampaignWanted,
    PassedShare,
)
from hil.service.jobs.command_process import CommandProcess, kill_left
from hil.service.jobs.job_repository import JobRepository, files_in_results
from hil.service.jobs.shared_results import SharedResults
from hil.service.store import in_turns
from hil.service.worker_pool import WorkerPool

_AT_ONCE = 1  # each has every processor that campaigns may use
_MOST_WAITING = 20
_LOOK_S = 1.0
_FREE_WITHIN_S = 30.0  # processes of a killed one end by themselves
_LAST_WORDS_S = 5.0
_GIVEN, _RESULTS, _SUMMARY = "given", "results", "campaign.json"
_INTERRUPTED = 130

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Places:
    """What a campaign may name: the folder of plans and controllers, models and benches by name."""

    plans: Path
    models: Mapping[str, Path]
    benches: Mapping[str, Path]


@dataclass
class _Going:
    """One under way: its process once there is one, how far it was when that began, and how far it is now."""

    process: CommandProcess | None = None
    began: tuple[float, int] | None = None
    told: dict[str, Any] = field(default_factory=dict)


class Campaigns:
    """All of them, by number.

    Args:
        folder: where each has a folder of its own.
        command: starts `hil campaign`, with what says who simulates.
        worker_pool: reads campaigns and their tables.
        shared: those of other services.
    """

    def __init__(
        self,
        folder: Path,
        command: Sequence[str],
        worker_pool: WorkerPool,
        shared: SharedResults[CampaignData],
    ) -> None:
        self._command, self._worker_pool, self._shared = command, worker_pool, shared
        self._turn = asyncio.Semaphore(_AT_ONCE)
        self._tasks: dict[int, asyncio.Task[None]] = {}
        self._going: dict[int, _Going] = {}
        self._closing = False
        self._records = JobRepository(folder, "state.json", CampaignData, shared.draw)

    def go_on(self) -> None:
        """Begin anew what was under way when the service before this one ended, oldest first."""
        for campaign in reversed(list(self._records)):
            if campaign.state in CAMPAIGN_OVER:
                continue
            kill_left(self._records.folder_of(campaign.id), self.results(campaign.id))
            stopped = campaign.state == "stopping"
            state = "cancelled" if stopped else "waiting"
            self._records.change(campaign.id, state=state, reason="cancelled" if stopped else "")
            if not stopped:
                self._begin(campaign.id)

    def all(self) -> list[CampaignData]:
        """Newest first, also those of other services."""
        return self._shared.with_others(self.own())

    def get(self, number: int) -> CampaignData | None:
        """One of them."""
        found = self._records.get(number)
        return self._shared.other(number) if found is None else self._shown(found)

    def own(self) -> list[CampaignData]:
        """Those of this service, newest first."""
        return [self._shown(one) for one in self._records]

    def to_tell(self) -> list[CampaignData]:
        """Those of this service as they are now, without the names of their files."""
        return [one if self.is_over(one) else self._shown(one) for one in self._records]

    def is_over(self, one: CampaignData) -> bool:
        """Whether it leaves no more files, unless it is gone on with."""
        return one.state in CAMPAIGN_OVER

    def is_removed(self, number: int) -> bool:
        """Whether one was here and is removed."""
        return self._records.is_removed(number)

    async def file(self, number: int, name: str) -> Path:
        """A file of one, brought here if it is another service's.

        Raises:
            ArchiveAwayError: the archive does not give it.
        """
        here = self._records.get(number) is not None
        return self.results(number) / name if here else await self._shared.bring(number, name)

    async def share(self) -> str:
        """Tell other services of them, and keep their files for all; what keeps one from it."""
        return await self._shared.share(self)

    @property
    def not_stored(self) -> int:
        """How many that are over have files which the archive has not."""
        return self._shared.waiting

    async def examples(self) -> list[CampaignExample]:
        """The built-in ones."""
        found = await self._worker_pool.ask("campaign_examples")
        return [CampaignExample(**one) for one in found["examples"]]

    async def add(self, wanted: CampaignWanted, places: Places, by: str) -> CampaignData:
        """Have one carried out in its turn.

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
        self._begin(number)
        return campaign

    async def cancel(self, number: int) -> bool:
        """End one: what is under way is awaited and kept; asked twice, it is not. False if it is over."""
        task, going = self._tasks.get(number), self._going.get(number)
        if task is None:
            return False
        if going is not None and going.process is not None:
            self._records.change(number, state="stopping")
            going.process.interrupt()
            return True
        task.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await task
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
        self._begin(number)
        return True

    def remove(self, number: int) -> bool:
        """Remove one that is over, with its files; False if it is not over."""
        found = self._records.get(number)
        if found is None or found.state not in CAMPAIGN_OVER or number in self._tasks:
            return False
        self._records.remove(number)
        return True

    async def close(self) -> None:
        """End all that are under way: a service that begins again goes on with them."""
        self._closing = True
        for number, going in self._going.items():
            if going.process is not None:
                logger.info("campaign %d is ended with the service", number)
                going.process.kill()
        for task in self._tasks.values():
            task.cancel()
        await asyncio.gather(*self._tasks.values(), return_exceptions=True)

    def _refuse_too_many(self) -> None:
        if len(self._tasks) >= _MOST_WAITING:
            raise BadInputError(
                f"{_MOST_WAITING} campaigns are already queued", where="campaign", fix="cancel one of them"
            )

    def _begin(self, number: int) -> None:
        self._tasks[number] = asyncio.create_task(in_turns(self._carried_out(number)))

    async def _carried_out(self, number: int) -> None:
        try:
            async with self._turn:
                going = self._going[number] = _Going()
                make_directory(self.results(number))
                await self._free(number)
                self._records.change(number, state="running")
                code, said = await self._simulated(number, going)
                await self._look(number, going)
                await self._write_table(number)
            self._end(number, code, said, going.told)
        except asyncio.CancelledError:
            self._end(number, _INTERRUPTED)
            raise
        except (HilError, OSError) as error:
            self._end(number, HilError.exit_code, str(error))
        finally:
            self._going.pop(number, None)
            self._tasks.pop(number, None)

    async def _free(self, number: int) -> None:
        """Wait until nobody writes there: processes that a killed service has left may still be ending.

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

    async def _simulated(self, number: int, going: _Going) -> tuple[int, str]:
        folder = self._records.folder_of(number)
        file = folder / _GIVEN / "campaign.yaml"
        command = [*self._command, str(file.resolve()), "--resume"]
        process = await CommandProcess.begin(command, folder, self.results(number))
        going.process = process
        over = asyncio.ensure_future(process.over())
        try:
            while not over.done():
                await self._look(number, going)
                await asyncio.wait([over], timeout=_LOOK_S)
            return over.result()
        finally:
            over.cancel()
            await process.end(_LAST_WORDS_S)

    async def _write_table(self, number: int) -> None:
        try:
            await self._worker_pool.ask(
                "campaign_table", folder=self._at(number), file=self._at(number, TABLE)
            )
        except HilError as error:
            logger.warning("campaign %d has its table in parts only: %s", number, error)

    async def _look(self, number: int, going: _Going) -> None:
        """What is on disk by now, and how many a second came since it began."""
        try:
            found = await self._worker_pool.ask("campaign_so_far", folder=self._at(number))
        except HilError as error:
            logger.warning("campaign %d: %s", number, error)
            return
        now_s, done = time.monotonic(), found["done"]
        going.began = going.began or (now_s, done)
        rate_hz = (done - going.began[1]) / max(now_s - going.began[0], _LOOK_S)
        shares = [PassedShare(**one) for one in found["controllers"]]
        campaign = self._records.get(number)
        if campaign is not None and campaign.draws == 0:  # chosen values are no sample
            shares = [share.model_copy(update={"interval": None}) for share in shares]
        going.told = {"done": done, "rate_hz": rate_hz, "controllers": shares}

    def _end(self, number: int, code: int, said: str = "", told: Mapping[str, Any] | None = None) -> None:
        """Write down what came of it; a service that is closing leaves it to the next one."""
        if self._closing:
            return
        changes = {**(told or {}), "rate_hz": 0.0, "ended_at": datetime.datetime.now(datetime.UTC)}
        if code in (0, 1):
            changes |= {"state": "ended", "reason": "", "passed": self._passed(number)}
        elif code == _INTERRUPTED:
            changes |= {"state": "cancelled", "reason": "cancelled"}
        else:
            changes |= {"state": "failed", "reason": said}
        self._records.change(number, **changes)

    def _passed(self, number: int) -> bool | None:
        with contextlib.suppress(OSError, ValueError):
            found = json.loads((self.results(number) / _SUMMARY).read_bytes())["passed"]
            return found if isinstance(found, bool) else None
        return None

    def _shown(self, campaign: CampaignData) -> CampaignData:
        if campaign.state in CAMPAIGN_OVER:
            return campaign.model_copy(update={"files": files_in_results(self.results(campaign.id))})
        going = self._going.get(campaign.id)
        return campaign if going is None else campaign.model_copy(update=going.told)

    def results(self, number: int) -> Path:
        """Where the files of one of this service are."""
        return self._records.folder_of(number) / _RESULTS

    def _at(self, number: int, name: str = "") -> str:
        return str((self.results(number) / name).resolve())
