"""The catalogues of models, controllers and bench files: shipped ones and uploads, and their API data."""

from __future__ import annotations

import contextlib
import functools
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar

from hil.api_schemas.design import ControllerData, ModelData
from hil.api_schemas.file_check import BenchFileData
from hil.core.controller import Controller, controller_from_toml
from hil.core.errors import BadInputError
from hil.core.errors.wording import shortened
from hil.core.files import read_text
from hil.core.files.toml_file import parse_toml
from hil.core.model import Model, load_model, model_from_dict
from hil.engine.bench.bench_file import shipped, shipped_benches
from hil.plant import refuse_too_stiff
from hil.service.files.uploads import NameTakenError, Uploads
from test_plans import library_controllers

T = TypeVar("T")
_KEPT = 200  # texts that stay read


@dataclass(frozen=True)
class BenchSummary:
    """What a bench file says of itself."""

    title: str
    simulated: bool


class Catalogue(Generic[T]):
    """Files of one kind by name. A name stands for one content: who wants to change it gives a new name.

    Args:
        given: those that people gave, each as `<name>.toml`.
        built_in: files that are always there.
        parse: makes of a file's text what it says; BadInputError if it cannot be used.
    """

    def __init__(self, given: Uploads, built_in: Mapping[str, Path], parse: Callable[[str, str], T]) -> None:
        self._given, self._built_in = given, dict(built_in)
        self._parse = functools.lru_cache(_KEPT)(parse)

    def paths(self) -> dict[str, Path]:
        """Where all are by name, those that are built in first."""
        return {**self._built_in, **{n: p for n, p in self._given.paths().items() if n not in self._built_in}}

    def is_built_in(self, name: str) -> bool:
        """Whether it is always there."""
        return name in self._built_in

    def path(self, name: str) -> Path | None:
        """Where it is; None if there is none."""
        return self._built_in[name] if name in self._built_in else self._given.path(name)

    def read(self, path: Path) -> T:
        """What one says that lies there.

        Raises:
            BadInputError: it cannot be read any more.
        """
        return self._parse(read_text(path), path.name)

    def give(self, name: str, text: str, by: str, based_on: str = "") -> T:
        """Keep one; the same text may be given again.

        Raises:
            NameTakenError: the name stands for another.
            BadInputError: it cannot be used.
        """
        if self.is_built_in(name):
            raise NameTakenError("is the name of a built-in one", where=name, fix="give it another name")
        found = self._parse(text, f"{name}.toml")
        self._given.give(name, text, by, based_on=based_on)
        return found

    def remove(self, name: str) -> bool:
        """Remove one that was given; false if there is none."""
        return not self.is_built_in(name) and self._given.remove(name)


def model_catalogue(given: Uploads) -> Catalogue[Model]:
    """Models: the shipped ones are those beside the shipped benches."""
    return Catalogue(given, _shipped_models(), _model)


def controller_catalogue(given: Uploads) -> Catalogue[Controller]:
    """Controllers; given ones lie in the folder of the plans, which find them there by their names."""
    return Catalogue(given, library_controllers(), controller_from_toml)


def bench_catalogue(given: Uploads) -> Catalogue[BenchSummary]:
    """Bench files; given ones name device files and models that the service has."""
    return Catalogue(given, {name: shipped(f"{name}.toml") for name in shipped_benches()}, _bench)


def bench_file_data(catalogue: Catalogue[BenchSummary], name: str, path: Path) -> BenchFileData:
    """What is shown of a bench file that lies there.

    Raises:
        BadInputError: it cannot be read any more.
    """
    found = catalogue.read(path)
    return BenchFileData(
        name=name, title=found.title, simulated=found.simulated, built_in=catalogue.is_built_in(name)
    )


def model_data(catalogue: Catalogue[Model], name: str, path: Path) -> ModelData:
    """What is shown of a model that lies there.

    Raises:
        BadInputError: it cannot be read any more.
    """
    model = catalogue.read(path)
    return ModelData(
        name=name,
        kind=model.kind,
        built_in=catalogue.is_built_in(name),
        effects=[use.id for use in model.effects],
        warning=model.doubt,
    )


def controller_data(catalogue: Catalogue[Controller], name: str, path: Path) -> ControllerData:
    """What is shown of a controller that lies there.

    Raises:
        BadInputError: it cannot be read any more.
    """
    controller = catalogue.read(path)
    warnings = controller.meta.get("warnings")
    return ControllerData(
        name=name,
        built_in=catalogue.is_built_in(name),
        stabilisation=controller.stabilization,
        warnings=[str(one) for one in warnings] if isinstance(warnings, list) else [],
    )


def _model(text: str, where: str) -> Model:
    model = model_from_dict(parse_toml(text, where), where, text)
    refuse_too_stiff(model)
    return model


def _bench(text: str, where: str) -> BenchSummary:
    data = parse_toml(text, where)
    return BenchSummary(shortened(str(data.get("title", "")), 200), "simulation" in data)


def _shipped_models() -> dict[str, Path]:
    found = {}
    for path in sorted(shipped("sim.toml").parent.glob("*.toml")):
        with contextlib.suppress(BadInputError):  # a bench file
            load_model(path)
            found[path.stem] = path
    return found
