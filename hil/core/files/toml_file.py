"""TOML files as people write them: what is wrong with one is reported, and none is too large."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

from hil.core.errors import BadInputError
from hil.core.errors.wording import printable
from hil.core.files import read_text

#: Model and controller files hold some thousand numbers at most; tomllib needs a second for each of these.
LARGEST_BYTES = 5_000_000
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


def toml_text(path: Path) -> str:
    """Text of a TOML file.

    Raises:
        BadInputError: not readable, no regular file, or far too large.
    """
    return read_text(path, LARGEST_BYTES, "give the TOML file of a model, a controller or a bench")


def parse_toml(text: str, where: str, fix: str = "") -> dict[str, Any]:
    """Contents of a TOML text; `where` names it in messages, `fix` is what to do.

    Raises:
        BadInputError: not TOML, or keys of too many parts.
    """
    _refuse_long_keys(text, where)
    try:
        return tomllib.loads(text)
    except ValueError as error:  # also numbers of more digits than Python converts
        raise BadInputError(f"not a TOML file: {printable(error, 200)}", where=where, fix=fix) from error
    except RecursionError as error:
        raise BadInputError("not a TOML file: nested too deeply", where=where, fix=fix) from error


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
