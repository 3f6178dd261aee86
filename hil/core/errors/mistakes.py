"""All that is wrong with a file, reported at once: each mistake with its line, key and remedy.

Tables of a TOML file are checked by pydantic; its errors get key, value and what would be right.
"""

from __future__ import annotations

import contextlib
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, get_args

from pydantic import BaseModel, ValidationError

from hil.core.errors import BadInputError
from hil.core.errors.wording import closest, listed, printable


@dataclass(frozen=True)
class Mistake:
    """One of them; `key` is dotted and tells the line, `what` names it too."""

    key: str
    what: str
    fix: str = ""


def keyed(mistake: str) -> Mistake:
    """A mistake whose words begin with its key: `limits.shaft_torque_nm = 'x': ...`."""
    return Mistake(mistake.partition(": ")[0].partition(" = ")[0], mistake)


class MistakesError(BadInputError):
    """What is wrong with a file or with a part of it, one or several."""

    def __init__(self, what: str, *, where: str = "", fix: str = "", found: tuple[Mistake, ...] = ()) -> None:
        super().__init__(what, where=where, fix=fix)
        self.found = found


class Mistakes:
    """What is wrong with a file, collected while the rest of it is still looked at."""

    def __init__(self) -> None:
        self._found: list[Mistake] = []

    @contextlib.contextmanager
    def of(self, key: str) -> Iterator[None]:
        """Collect what is refused of a key, and go on behind the block."""
        try:
            yield
        except MistakesError as error:
            for mistake in error.found:
                inner = f"{key}.{mistake.key}" if key and mistake.key else key or mistake.key
                self._found.append(Mistake(inner, mistake.what, mistake.fix))
        except BadInputError as error:
            self._found.append(Mistake(key, error.what, error.fix))

    def refuse(self, where: str, text: str = "") -> None:
        """Raise what was found, if anything.

        Raises:
            MistakesError: all mistakes.
        """
        refuse(where, self._found, text)


def refuse(where: str, mistakes: Iterable[Mistake], text: str = "", fix: str = "") -> None:
    """Tell the mistakes of a file, each on a line, as many as somebody reads; nothing if there is none.

    Args:
        where: the file.
        text: its text, for lines.
        fix: what to do, where a mistake does not say it.

    Raises:
        MistakesError: there are mistakes; its `found` has all of them.
    """
    found = tuple(dict.fromkeys(mistakes))
    if len(found) == 1:
        line = line_of(text, found[0].key)
        place = f"{where}, line {line}" if line else where
        raise MistakesError(found[0].what, where=place, fix=found[0].fix or fix, found=found)
    if found:
        lines_by_key = lines_of(text)
        placed = [(nearest(lines_by_key, mistake.key) or 0, mistake) for mistake in found]
        placed.sort(key=lambda one: one[0])
        lines = listed([_on_a_line(mistake, line) for line, mistake in placed])
        raise MistakesError(f"{len(found)} mistakes{lines}", where=where, fix=fix, found=found)


def all_of(errors: Iterable[BadInputError]) -> None:
    """Tell what is wrong with several files; nothing if nothing is.

    Raises:
        BadInputError: the only error, or all of them.
    """
    found = list(errors)
    if len(found) == 1:
        raise found[0]
    if found:
        words = "".join(f"\n{error}" for error in found)
        raise BadInputError(f"{len(found)} files cannot be used{words}")


def _on_a_line(mistake: Mistake, line: int) -> str:
    words = f"{mistake.what}; {mistake.fix}" if mistake.fix else mistake.what
    return f"line {line}: {words}" if line else words


_HEADER = re.compile(r"^\s*\[\s*([^\[\]]+?)\s*\]\s*(?:#.*)?$")
_ENTRY = re.compile(r"^\s*\[\[\s*([^\[\]]+?)\s*\]\]\s*(?:#.*)?$")
_KEY = re.compile(r"""^\s*((?:[\w-]+|"[^"]*"|'[^']*')(?:\s*\.\s*(?:[\w-]+|"[^"]*"|'[^']*'))*)\s*=""")
_ENTRY_OF_A_LIST = re.compile(r"\[[^\[]*\]$")
_PART = re.compile(r"""[\w-]+|"[^"]*"|'[^']*'""")


def line_of(text: str, key: str) -> int | None:
    """Line of a dotted key, or of the nearest around it; None if none has a line."""
    return nearest(lines_of(text), key)


def nearest(lines: Mapping[str, int], key: str) -> int | None:
    """Line of a dotted key of `lines_of`, or of the nearest around it; None if none has one."""
    while key and key not in lines:
        key = _ENTRY_OF_A_LIST.sub("", key) if key.endswith("]") else key.rpartition(".")[0]
    return lines.get(key)


def lines_of(text: str) -> dict[str, int]:
    """Line of each dotted key (`effects[2].id` in the second of several tables).

    What stands inside of an inline table or of a text over several lines may be missed.
    """
    lines: dict[str, int] = {}
    table = ""
    entries: Counter[str] = Counter()
    for number, line in enumerate(text.splitlines(), 1):
        if header := _HEADER.match(line):
            table = _dotted(header[1])
            lines.setdefault(table, number)
        elif entry := _ENTRY.match(line):
            name = _dotted(entry[1])
            entries[name] += 1
            table = f"{name}[{entries[name]}]"
            lines.setdefault(name, number)
            lines[table] = number
        elif found := _KEY.match(line):
            name = _dotted(found[1])
            lines.setdefault(f"{table}.{name}" if table else name, number)
    return lines


def _dotted(name: str) -> str:
    return ".".join(part.strip("\"'") for part in _PART.findall(name))


def mistakes_of(
    error: ValidationError, model: type[BaseModel], key: str = "", known: list[str] | None = None
) -> list[str]:
    """Each of pydantic's errors: key, value, and what would be right.

    Args:
        model: what the table should be.
        key: of the table that was checked.
        known: mistakes that were reported; what concerns the same table again is left out.
    """
    tables = {keyed(mistake).key for mistake in known or ()}
    found, meant = [], _meant(error, model)
    places = [mistake["loc"] for mistake in error.errors()]
    for mistake in error.errors():
        loc = mistake["loc"]
        if mistake["type"] == "missing" and loc in meant:
            continue
        if mistake["type"] == "too_short" and any(one[: len(loc)] == loc != one for one in places):
            continue  # it counts the entries that are right
        place = (key, *mistake["loc"]) if key else mistake["loc"]
        name = printable(dotted(place), 120)
        if not any(table == name or table.startswith(f"{name}.") for table in tables):
            found.append(_in_words(name, dict(mistake), model))
    return found


def dotted(place: Iterable[int | str]) -> str:
    """Where pydantic finds a mistake, as a key; entries of lists are counted from 1, as by `lines_of`."""
    parts = [f"[{part + 1}]" if isinstance(part, int) else f".{part}" for part in place if part != "[key]"]
    return "".join(parts).removeprefix(".")


def _in_words(name: str, mistake: dict[str, Any], model: type[BaseModel]) -> str:
    if mistake["type"] == "missing":
        return f"{name}: is missing"
    if mistake["type"] == "extra_forbidden":
        return f"{name}: unknown key{_suggestion(mistake['loc'], model)}"
    value = mistake["input"]
    if mistake["type"] == "value_error" and isinstance(value, dict):  # of several of its keys
        return f"{name}: {needed(mistake)}"
    shown = "a table" if isinstance(value, dict) else printable(repr(value), 60)
    return f"{name} = {shown}: {needed(mistake)}"


def _meant(error: ValidationError, model: type[BaseModel]) -> set[tuple[int | str, ...]]:
    """Keys whose misspelling is reported: that they are missing need not be."""
    unknown = [one["loc"] for one in error.errors() if one["type"] == "extra_forbidden"]
    return {(*place[:-1], _closest(place, model)) for place in unknown}


def _suggestion(place: tuple[int | str, ...], model: type[BaseModel]) -> str:
    near = _closest(place, model)
    return f"; did you mean '{near}'?" if near else ""


def _closest(place: tuple[int | str, ...], model: type[BaseModel]) -> str:
    """The key of the same table that may have been meant, or ''."""
    table: type[BaseModel] | None = model
    for part in place[:-1]:
        field = table.model_fields.get(str(part)) if table else None
        if field is not None:  # else the name of one of several tables of a kind
            table = _table_in(field.annotation)
    return closest(str(place[-1]), table.model_fields if table else ())


def _table_in(annotation: Any) -> type[BaseModel] | None:
    """The table that a field holds, alone, optional or several by name."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next((found for part in get_args(annotation) if (found := _table_in(part))), None)


_BOUNDS = {
    "greater_than": ("gt", "more than"),
    "greater_than_equal": ("ge", "at least"),
    "less_than": ("lt", "less than"),
    "less_than_equal": ("le", "at most"),
}
_KINDS = {
    "float_type": "a number",
    "float_parsing": "a number, without quotes",
    "int_type": "a whole number",
    "int_parsing": "a whole number, without quotes",
    "int_from_float": "a whole number",
    "finite_number": "a finite number",
    "string_type": "a text in quotes",
    "bool_type": "true or false",
    "bool_parsing": "true or false",
    "dict_type": "a table",
    "model_type": "a table",
    "mapping_type": "a table",
    "list_type": "a list",
    "tuple_type": "a list",
}


def needed(mistake: Mapping[str, Any]) -> str:
    """What the value of one of pydantic's `errors()` should have been: 'must be at most 127'."""
    kind, context = str(mistake["type"]), mistake.get("ctx", {})
    if kind in _BOUNDS:
        key, words = _BOUNDS[kind]
        return f"must be {words} {_number(context[key])}"
    if kind in _KINDS:
        return f"must be {_KINDS[kind]}"
    if kind == "literal_error":
        return f"must be {context['expected']}"
    if kind == "string_too_short":
        least = context["min_length"]
        return "must not be empty" if least == 1 else f"must have at least {least} characters"
    if kind == "string_too_long":
        return f"must have at most {context['max_length']} characters"
    if kind in ("too_short", "too_long"):
        least, most = context.get("min_length"), context.get("max_length")
        bound = f"at most {most}" if least is None else f"at least {least}"
        one = 1 in (least, most)
        return f"must have {bound} {'entry' if one else 'entries'}, not {_count(context['actual_length'])}"
    text = str(mistake["msg"]).removeprefix("Value error, ").removeprefix("Assertion failed, ")
    text = f"{text[:1].lower()}{text[1:]}"
    return text.replace("input should", "must", 1)


def _count(length: object) -> str:
    return "none" if length == 0 else str(length)  # pydantic does not count an iterator to its end


def _number(value: object) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
