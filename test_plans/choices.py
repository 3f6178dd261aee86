"""What a person chooses for one run of a plan; the plan's text then says so, as if it had been written so."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from hil.core.errors import BadInputError
from hil.core.errors.wording import did_you_mean, printable
from test_plans.building import build, mapping_at
from test_plans.variables import EXAMPLE, Variable
from test_plans.variables import KEY as VARIABLES
from test_plans.yaml_document import Document, KeyPath

_STEP, _FILE = "set_controller", "file"


@dataclass(frozen=True)
class Choices:
    """What replaces what a plan says.

    Attributes:
        controllers: controller files by the plan's name for what each replaces; '' for the only one.
        values: of the plan's variables, by name.
    """

    controllers: Mapping[str, Path] = field(default_factory=dict)
    values: Mapping[str, float] = field(default_factory=dict)

    def applied(self, text: str, document: Document) -> str:
        """The plan's text with everything that was chosen in its place.

        Raises:
            BadInputError: the plan has nothing of that name, or a value is beyond a variable's bounds.
        """
        changes = dict(_controllers(document, self.controllers))
        changes |= dict(_values(document, self.values))
        for start, end in sorted(changes, reverse=True):
            text = text[:start] + changes[start, end] + text[end:]
        return text


def controller_choices(given: list[str], option: str) -> dict[str, Path]:
    """Controller files as given on a command line: FILE, or NAME=FILE.

    Raises:
        BadInputError: there is no such file.
    """
    chosen: dict[str, Path] = {}
    for text in given:
        name, sign, file = text.partition("=")
        if not sign or Path(text).is_file():  # its own name may have a '='
            name, file = "", text
        if not Path(file).is_file():
            raise BadInputError(
                f"there is no file '{printable(file, 200)}'",
                where=option,
                fix="give a controller file, or NAME=FILE with the name that the plan has for it",
            )
        if name in chosen:
            raise BadInputError(f"{option} is given twice for the same controller", fix="give it once")
        chosen[name] = Path(file)
    return chosen


def named_controllers(document: Document) -> dict[KeyPath, str]:
    """What a plan calls the controller files that it loads, by where it says so."""
    return dict(_named(document.value, ()))


def _values(document: Document, chosen: Mapping[str, float]) -> Iterator[tuple[tuple[int, int], str]]:
    """Places of variables' defaults in the text, with the numbers that come there."""
    content = document.value
    known = content.get(VARIABLES) if isinstance(content, dict) else None
    for name, value in chosen.items():
        if not isinstance(known, dict) or name not in known:
            raise BadInputError(
                f"has no variable '{printable(name, 60)}'",
                where=document.where,
                fix=did_you_mean(name, known if isinstance(known, dict) else ()),
            )
        path: KeyPath = (VARIABLES, name)
        variable = build(Variable, mapping_at(known[name], document, path, EXAMPLE), document, path)
        whole = isinstance(known[name]["default"], int) and float(value).is_integer()
        objection = variable.objection(value)
        if objection:
            raise BadInputError(f"{name} = {objection}", where=document.place(path))
        yield document.spans[*path, "default"], repr(int(value) if whole else float(value))


def _controllers(document: Document, chosen: Mapping[str, Path]) -> Iterator[tuple[tuple[int, int], str]]:
    """Places of controller files' names in the text, with the names that come there."""
    if not chosen:
        return
    places = dict(_named(document.value, ()))
    names = list(dict.fromkeys(places.values()))
    for name in chosen:
        if not names:
            raise BadInputError(
                "loads no controller file", where=document.where, fix="leave --controller out"
            )
        if not name and len(names) > 1:
            raise BadInputError(
                f"loads {len(names)} controllers: {', '.join(names)}",
                where=document.where,
                fix=f"select the one to replace: --controller {names[0]}={chosen[name]}",
            )
        if name and name not in names:
            raise BadInputError(
                f"loads no controller '{printable(name, 60)}'",
                where=document.where,
                fix=did_you_mean(name, names),
            )
    for path, name in places.items():
        file = chosen.get(name, chosen.get(""))
        if file is not None:
            yield document.spans[path], json.dumps(str(file.resolve()), ensure_ascii=False)


def _named(value: object, path: KeyPath) -> Iterator[tuple[KeyPath, str]]:
    """Where `set_controller` names a file, also within other steps."""
    if isinstance(value, dict):
        loaded = value.get(_STEP)
        if isinstance(loaded, dict) and isinstance(loaded.get(_FILE), str):
            yield (*path, _STEP, _FILE), loaded[_FILE]
        for key, item in value.items():
            yield from _named(item, (*path, key))
    elif isinstance(value, list):
        for index, item in enumerate(value):
            yield from _named(item, (*path, index))
