"""Folders in which earlier versions kept what was given: taken into the database when a service begins.

A file goes once the database has its text under its name, so that a service that is killed goes on with the
next one. What another service has given under the same name with another content stays, and is reported.
"""

from __future__ import annotations

import logging
import socket
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from hil.api_schemas.api import PlanName
from hil.api_schemas.design import FileName
from hil.api_schemas.upload import GivenKind, KeptApart
from hil.core.errors import BadInputError
from hil.core.files import read_text
from hil.execution.data_folder import files_of
from hil.service.files.catalogues import Catalogue
from hil.service.files.plans import Plans
from hil.service.store import GivenStore, LogStore
from test_plans import plan_from_text

_NAMES: dict[GivenKind, TypeAdapter[str]] = {
    "model": TypeAdapter(FileName),
    "controller": TypeAdapter(FileName),
    "plan": TypeAdapter(PlanName),
}
_FIX = "upload it under another name, or remove the file; the service reads it again at its next start"

logger = logging.getLogger(__name__)


class LegacyImport:
    """`plans` (with controllers) and `models` of a service's folder."""

    def __init__(
        self,
        folder: Path,
        store: GivenStore,
        log: LogStore,
        plans: Plans,
        controllers: Catalogue[Any],
        models: Catalogue[Any],
    ) -> None:
        self._folder, self._store, self._log = folder, store, log
        self._plans, self._controllers, self._models = plans, controllers, models
        self._by = f"an earlier version on {socket.gethostname()}"
        self._apart: list[KeptApart] = []

    def take_in(self) -> list[KeptApart]:
        """Take in all that can be; what stays where it is, and why."""
        for path in _files(self._folder / "models", ".toml"):
            self._take("model", path, lambda name, text: self._models.give(name, text, self._by))
        for path in _files(self._folder / "plans", ".toml"):
            self._take("controller", path, lambda name, text: self._controllers.give(name, text, self._by))
        for path in _files(self._folder / "plans", ".yaml"):
            self._take("plan", path, self._give_plan)
        for name in ("models", "plans"):
            place = self._folder / name
            if place.is_dir() and not any(place.iterdir()):
                place.rmdir()
        return self._apart

    def _take(self, kind: GivenKind, path: Path, give: Callable[[str, str], object]) -> None:
        try:
            self._have_in_database(kind, path, give)
            path.unlink()
        except BadInputError as error:
            self._keep_apart(kind, path, error.what, error.fix or _FIX)
        except OSError as error:
            self._keep_apart(kind, path, f"it is shared, and cannot be removed here: {error.strerror}", _FIX)

    def _have_in_database(self, kind: GivenKind, path: Path, give: Callable[[str, str], object]) -> None:
        name, text = path.stem, read_text(path)
        try:
            _NAMES[kind].validate_python(name)
        except ValidationError as error:
            raise BadInputError("nothing can be given under its name", fix="rename it") from error
        there = self._store.get(kind, name)
        if there is None:
            give(name, text)
            self._log.add("service", "", f"{kind} given", name, f"it lay in {path}")
        elif there.removed:
            raise BadInputError("its name was removed from the database", fix=_FIX)
        elif there.text != text:
            by = f", given by {there.given_by}" if there.given_by else ""
            raise BadInputError(f"the database has another content under its name{by}", fix=_FIX)

    def _keep_apart(self, kind: GivenKind, path: Path, why: str, fix: str) -> None:
        logger.warning("%s stays as it is and is not shared: %s", path, why)
        file = path.relative_to(self._folder)
        self._apart.append(KeptApart(kind=kind, name=path.stem, file=str(file), why=why, fix=fix))

    def _give_plan(self, name: str, text: str) -> None:
        apart = {one.name for one in self._apart if one.kind == "controller"}
        where = f"{name}.yaml"
        for file in files_of(plan_from_text(text, where, self._folder / "plans", files_required=False)):
            if file.stem in apart:
                raise BadInputError(f"it loads {file.name}, which stays too", fix=_FIX)
        self._plans.give(name, text, self._by, replace=False)


def _files(folder: Path, ending: str) -> Iterator[Path]:
    if folder.is_dir():
        yield from sorted(path for path in folder.glob(f"[!.]*{ending}") if path.is_file())
