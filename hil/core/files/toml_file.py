"""TOML files as people write them: bounded, every mistake reported, their kind known by their keys."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, WithJsonSchema

from hil.core.errors import BadInputError
from hil.core.errors.wording import printable
from hil.core.files import read_text

Kind = Literal["bench file", "model", "controller", "plan"]

_SIGNS: Mapping[Kind, frozenset[str]] = {
    "bench file": frozenset({"buses", "rmcu", "dyno", "simulation"}),
    "model": frozenset({"kind", "parameters", "transfer_functions"}),
    "controller": frozenset({"dfc", "wsc", "dfo"}),
    "plan": frozenset({"steps", "criteria"}),
}
_GIVEN: Mapping[Kind, str] = {
    "bench file": "give it as --bench FILE to a command that takes one, as 'hil run' does",
    "model": "give it as --model FILE, or name it under [simulation] of a bench file",
    "controller": "give it as --controller FILE, or name it in a plan's set_controller",
    "plan": "give it to 'hil check' or 'hil run' as PLAN",
}


def kind_of(data: Mapping[str, Any]) -> Kind | None:
    """What its keys say a file is, None where they say nothing or two things."""
    found: list[Kind] = [kind for kind, signs in _SIGNS.items() if signs & data.keys()]
    return found[0] if len(found) == 1 else None


def refuse_other_kind(data: Mapping[str, Any], wanted: Kind, where: str) -> None:
    """Refuse a file that is another kind than `wanted`.

    Raises:
        BadInputError: says what it is and where it belongs.
    """
    kind = kind_of(data)
    if kind not in (None, wanted):
        raise BadInputError(f"this is a {kind}; a {wanted} is needed", where=where, fix=_GIVEN[kind])


#: What this version writes, and the newest that it reads.
FORMAT = 1
FORMAT_SCHEMA = {"const": FORMAT, "default": FORMAT, "description": "version of the format of this file"}


def readable_format(value: object) -> int:
    """The number of a format that this version reads.

    Raises:
        ValueError: it is another one.
    """
    if isinstance(value, bool) or not isinstance(value, int) or value < 1:
        raise ValueError(f"must be {FORMAT}")
    if value > FORMAT:
        raise ValueError(f"is of a newer version of this software; this one reads up to {FORMAT}")
    return value


FormatNumber = Annotated[int, BeforeValidator(readable_format), WithJsonSchema(FORMAT_SCHEMA)]


#: Model and controller files hold some thousand numbers at most; tomllib needs a second for each of these.
LARGEST_BYTES = 5_000_000
#: Where tomllib says that a text is no TOML.
_PLACE = re.compile(r" \(at (?:line (?P<line>\d+), column \d+|end of document)\)$")
#: Parts of a key or of a table's name. tomllib needs the square of their number: 25 s for 80 kB of `a.a.a…`.
MOST_PARTS = 32
_PART = re.compile(r"""\"(?:[^"\\\n]|\\.)*+\"|'[^'\n]*+'|[A-Za-z0-9_-]++""")
#: What is no key: strings over several lines, and comments; then keys, of which other values look like one.
_TOKEN = re.compile(
    r'"""(?:(?!""")(?:[^\\]|\\.))*+"""'
    r"|'''(?:(?!''').)*+'''"
    r"|\#[^\n]*+"
    rf"|(?P<key>(?:{_PART.pattern})(?:[ \t]*+\.[ \t]*+(?:{_PART.pattern}))*+)",
    re.DOTALL,
)


def toml_text(path: Path, fix: str = "give the TOML file of a model, a controller or a bench") -> str:
    """Text of a TOML file; `fix` is what to do if it is none.

    Raises:
        BadInputError: not readable, no regular file, or far too large.
    """
    return read_text(path, LARGEST_BYTES, fix)


def parse_toml(text: str, where: str, fix: str = "correct the file there") -> dict[str, Any]:
    """Contents of a TOML text; `where` names it in messages, `fix` is what to do.

    Raises:
        BadInputError: not TOML, or keys of too many parts.
    """
    _refuse_long_keys(text, where)
    try:
        return tomllib.loads(text)
    except ValueError as error:  # also numbers of more digits than Python converts
        what, place = _placed(str(error), text)
        raise BadInputError(f"not a TOML file: {what}", where=f"{where}{place}", fix=fix) from error
    except RecursionError as error:
        raise BadInputError("not a TOML file: nested too deeply", where=where, fix=fix) from error


def _placed(what: str, text: str) -> tuple[str, str]:
    """What tomllib says, and the place that it says it of, as other mistakes have theirs."""
    found = _PLACE.search(what)
    if found is None:
        return printable(what, 200), ""
    line = found["line"] or str(text.rstrip().count("\n") + 1)
    at_end = "" if found["line"] else ", at the end of the file"
    return f"{printable(what[: found.start()], 200)}{at_end}", f", line {line}"


def _refuse_long_keys(text: str, where: str) -> None:
    """Before tomllib sees them; in one pass over the text.

    Raises:
        BadInputError: a key has more parts than any that a file of ours has.
    """
    if text.count(".") < MOST_PARTS:
        return
    for found in _TOKEN.finditer(text):
        key = found["key"]
        if key is None or key.count(".") < MOST_PARTS:
            continue
        if sum(1 for _ in _PART.finditer(key)) > MOST_PARTS:
            line = text.count("\n", 0, found.start()) + 1
            raise BadInputError(
                f"a key has more than {MOST_PARTS} parts: {printable(key, 40)}",
                where=f"{where}: line {line}",
                fix="give the TOML file of a model, a controller or a bench",
            )
