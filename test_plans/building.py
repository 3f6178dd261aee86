"""From a part of a YAML document to a checked object; every mistake is reported, with line and key."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, NoReturn, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic_core import ErrorDetails

from hil.core.errors import BadInputError
from hil.core.errors.mistakes import needed
from hil.core.errors.wording import closest, did_you_mean, listed
from test_plans.yaml_document import Document, KeyPath


class PlanError(BadInputError):
    """Several mistakes of one plan; each is an error of its own, with its place."""

    def __init__(self, what: str, *, where: str = "", fix: str = "", found: tuple[BadInputError, ...] = ()):
        super().__init__(what, where=where, fix=fix)
        self.found = found


def plan_error(mistakes: Iterable[BadInputError]) -> BadInputError:
    """One error of all mistakes; the mistake itself if there is one only."""
    found = tuple({str(one): one for error in mistakes for one in getattr(error, "found", (error,))}.values())
    if len(found) == 1:
        return found[0]
    file = found[0].where.partition(": line ")[0]
    lines = listed([_on_a_line(one, file) for one in found])
    return PlanError(f"{len(found)} mistakes{lines}", where=file, found=found)


class PlanMistakes:
    """Mistakes that are collected while the rest of the plan is still looked at."""

    def __init__(self) -> None:
        self._found: list[BadInputError] = []

    def __bool__(self) -> bool:
        return bool(self._found)

    @contextlib.contextmanager
    def collected(self) -> Iterator[None]:
        """Collect what is refused in the block, and go on behind it."""
        try:
            yield
        except BadInputError as error:
            self._found.append(error)

    def refuse(self) -> None:
        """Raise what was found, if anything.

        Raises:
            BadInputError: the only mistake, or all of them.
        """
        if self._found:
            raise plan_error(self._found)


def _on_a_line(mistake: BadInputError, file: str) -> str:
    place = mistake.where.removeprefix(f"{file}: ")
    text = f"{mistake.what}; {mistake.fix}" if mistake.fix else mistake.what
    return f"{place}: {text}"


M = TypeVar("M", bound=BaseModel)


class Strict(BaseModel):
    """Base of everything in a plan: immutable, no unknown keys, no conversions, finite numbers."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)


def build(
    model: type[M],
    values: Mapping[str, Any],
    document: Document,
    path: KeyPath,
    context: object = None,
) -> M:
    """Make a `model` of `values`, which stand at `path` of the document.

    Raises:
        PlanError: names file, line and key of every wrong value, and what would be right.
    """
    try:
        return model.model_validate(dict(values), context=context)
    except ValidationError as error:
        _refuse(model, error, document, path)


def mapping_at(value: object, document: Document, path: KeyPath, example: str) -> dict[str, Any]:
    """`value` if it is a mapping, else BadInputError."""
    if not isinstance(value, dict):
        raise BadInputError(
            f"{brief(value)} is given where keys and values are needed",
            where=document.place(path),
            fix=f"write: {example}",
        )
    return value


def list_at(value: object, document: Document, path: KeyPath, example: str) -> list[Any]:
    """`value` if it is a list, else BadInputError."""
    if not isinstance(value, list):
        raise BadInputError(
            f"{brief(value)} is given where a list is needed",
            where=document.place(path),
            fix=f"begin each entry with a dash: {example}",
        )
    return value


def brief(value: object) -> str:
    """`value` as a message shows it, on one short line."""
    if isinstance(value, dict | list):
        return "a mapping" if isinstance(value, dict) else "a list"
    if value is None:
        return "nothing"
    shown = repr(value)
    return shown if len(shown) <= 60 else f"{shown[:57]}..."


def key_names(model: type[BaseModel]) -> list[str]:
    """The keys of `model` as they are written in YAML."""
    return [field.alias or name for name, field in model.model_fields.items()]


def _refuse(model: type[BaseModel], error: ValidationError, document: Document, path: KeyPath) -> NoReturn:
    # An unknown key is often the misspelling of one that is missing, which then need not be reported.
    unknown = [mistake for mistake in error.errors() if mistake["type"] == "extra_forbidden"]
    meant = {closest(str(mistake["loc"][-1]), key_names(model)) for mistake in unknown}
    others = [mistake for mistake in error.errors() if mistake["type"] != "extra_forbidden"]
    found = [*unknown, *(m for m in others if m["type"] != "missing" or str(m["loc"][-1]) not in meant)]
    raise plan_error([_in_words(model, mistake, document, path) for mistake in found]) from error


def _in_words(
    model: type[BaseModel], mistake: ErrorDetails, document: Document, path: KeyPath
) -> BadInputError:
    where = document.place((*path, *mistake["loc"]))
    model, key = _innermost(model, mistake["loc"])
    meaning = _meaning(model, key)
    match mistake["type"]:
        case "extra_forbidden":
            what, fix = f"unknown key {key!r}", did_you_mean(key, key_names(model))
        case "missing":
            what, fix = f"the key '{key}' is missing", f"{key}: {meaning}" if meaning else ""
        case "value_error" | "assertion_error":
            what, fix = str(mistake["ctx"]["error"]), ""
        case _:
            what, fix = f"{brief(mistake['input'])} {needed(mistake)}", f"{key}: {meaning}" if meaning else ""
    return BadInputError(what, where=where, fix=fix)


def _innermost(model: type[BaseModel], loc: tuple[int | str, ...]) -> tuple[type[BaseModel], str]:
    """The table in which a mistake lies, and its key there."""
    for place, part in enumerate(loc[:-1]):
        field = model.model_fields.get(str(part))
        inner = field.annotation if field else None
        if not (isinstance(inner, type) and issubclass(inner, BaseModel)):
            return model, str(loc[place])
        model = inner
    return model, str(loc[-1]) if loc else ""


def _meaning(model: type[BaseModel], key: str) -> str:
    for name, field in model.model_fields.items():
        if key in (name, field.alias):
            return field.description or ""
    return ""
