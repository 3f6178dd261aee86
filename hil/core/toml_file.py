"""TOML files as people write them: whatever is wrong with one is told, and none is too large to be read."""

from __future__ import annotations

import contextlib
import tomllib
from pathlib import Path
from typing import Any

from hil.core.errors import BadInputError
from hil.core.files import read_text
from hil.core.printable import printable

#: Model and controller files hold some thousand numbers at most; tomllib needs a second for each of these.
LARGEST_BYTES = 5_000_000


def toml_text(path: Path) -> str:
    """Text of a TOML file.

    Raises:
        BadInputError: not readable, or far too large.
    """
    with contextlib.suppress(OSError):  # what cannot be asked cannot be read: said below
        size = path.stat().st_size
        if size > LARGEST_BYTES:
            raise BadInputError(
                f"has {size / 1e6:.3g} MB, at most {LARGEST_BYTES / 1e6:g} MB are read",
                where=str(path),
                fix="is it a recording? Give the TOML file",
            )
    return read_text(path)


def parse_toml(text: str, where: str, fix: str = "") -> dict[str, Any]:
    """Contents of a TOML text; `where` names it in messages, `fix` is what to do.

    Raises:
        BadInputError: not TOML.
    """
    try:
        return tomllib.loads(text)
    except ValueError as error:  # also numbers of more digits than Python converts
        raise BadInputError(f"not a TOML file: {printable(error, 200)}", where=where, fix=fix) from error
    except RecursionError as error:
        raise BadInputError("not a TOML file: nested too deeply", where=where, fix=fix) from error
