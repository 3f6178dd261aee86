"""Uploads are parsed in another process first: the service does not wait for a hostile one."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from hil.api_schemas.api import PlanData
from hil.api_schemas.file_check import WrittenKind
from hil.api_schemas.upload import GivenKind
from hil.core.errors import BadInputError
from hil.service.files.plans import Plans
from hil.service.worker_pool import READ_WITHIN_S, READING, TooLongError, WorkerPool
from hil.service.worker_pool.plan_reading import GivenPlan
from test_plans import Plan

_CHECKED_WITHIN_S = 30.0


class UploadReader:
    """Reads texts apart, and gives plans that could be read."""

    def __init__(self, plans: Plans) -> None:
        self._plans = plans
        self._reading = WorkerPool(niceness=5)
        # What follows from a file is computed, which takes longer than to read it.
        self._checking = WorkerPool(niceness=5, read_within_s=_CHECKED_WITHIN_S)

    async def read(self, kind: GivenKind, name: str, text: str, **more: str) -> dict[str, Any]:
        """What another process reads of a text that somebody gives.

        Raises:
            BadInputError: it is none of its kind, or reading it takes too long.
            BenchError: that process failed.
        """
        try:
            return await self._reading.ask(f"{READING}{kind}", name=name, text=text, **more)
        except TooLongError as error:
            what = f"needs more than {READ_WITHIN_S:g} s of processor time to read"
            raise BadInputError(what, where=name, fix="make it shorter") from error

    async def plan(
        self, name: str, text: str, by: str, based_on: str = "", instead_of: str | None = None
    ) -> PlanData:
        """Keep a plan, read by another process first.

        Args:
            instead_of: SHA-256 of the text that it may replace, '' if the name has to be free; None replaces
                whatever is there.

        Raises:
            NameTakenError: a built-in plan has the name, or somebody else has given one just now.
            BadInputError: all that is wrong with it.
        """
        folder = str(self._plans.fresh_folder().resolve())
        found = await self.read("plan", name, text, folder=folder)
        read = GivenPlan(PlanData.model_validate(found["data"]), tuple(found["files"]))
        return self._plans.give(name, text, by, read=read, based_on=based_on, instead_of=instead_of)

    async def check_file(
        self, kind: WrittenKind, name: str, text: str, models: Mapping[str, Path], model: str = ""
    ) -> dict[str, Any]:
        """What follows from a model, a controller or a bench file: fields of `FileCheck`.

        Args:
            models: those of the service by name.
            model: that on which a controller's margins are; '' for none.

        Raises:
            BadInputError: all that is wrong with it, or reading it takes too long.
            BenchError: that process failed.
        """
        paths = {one: str(path.resolve()) for one, path in models.items()}
        try:
            return await self._checking.ask(
                f"{READING}file", kind=kind, name=name, text=text, models=paths, model=model
            )
        except TooLongError as error:
            what = f"needs more than {_CHECKED_WITHIN_S:g} s of processor time to check"
            raise BadInputError(what, where=name, fix="make it shorter") from error

    async def check(self, name: str, text: str) -> PlanData:
        """What a plan says that is not given yet.

        Raises:
            BadInputError: all that is wrong with it.
        """
        folder = str(self._plans.fresh_folder().resolve())
        return PlanData.model_validate((await self.read("plan", name, text, folder=folder))["data"])

    async def chosen(self, name: str, text: str, values: Mapping[str, float]) -> Plan:
        """A plan that is not given yet with its variables as chosen; another process has read it first.

        Raises:
            BadInputError: all that is wrong with it, or a value beyond its bounds.
        """
        await self.check(name, text)
        return self._plans.written(name, text, values)

    def close(self) -> None:
        """End the processes that read."""
        self._reading.close()
        self._checking.close()
