"""Opens what a recording can be: a file, not a folder, a pipe or a device that would never end."""

from __future__ import annotations

import os
import stat
from pathlib import Path
from typing import BinaryIO

from hil.core.errors import BadInputError

_KINDS = {
    stat.S_IFDIR: "a directory",
    stat.S_IFIFO: "a pipe",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
    stat.S_IFSOCK: "a socket",
}


def open_regular(path: Path) -> BinaryIO:
    """The file, opened for reading.

    Raises:
        BadInputError: there is none, it may not be read, or it is not a regular file.
    """
    refuse_unless_regular(path)
    try:
        return path.open("rb")
    except OSError as error:
        raise BadInputError(
            error.strerror or str(error), where=str(path), fix="check the path and its permissions"
        ) from error


def refuse_unless_regular(path: Path) -> None:
    """BadInputError tells why a path can be no recording; opens nothing, so that a pipe cannot block."""
    try:
        mode = path.stat().st_mode
    except ValueError as error:
        raise BadInputError(f"not a path: {error}", where=repr(str(path))) from error
    except OSError as error:
        reason = error.strerror or str(error)
        if path.is_symlink() and not path.exists():
            reason = f"{reason}: it is a link to {os.fspath(path.readlink())!r}"
        raise BadInputError(reason, where=str(path), fix="check the path") from error
    if not stat.S_ISREG(mode):
        kind = _KINDS.get(stat.S_IFMT(mode), "a special file")
        raise BadInputError(f"is {kind}, not a file", where=str(path), fix="a recording is a regular file")
