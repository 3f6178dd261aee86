"""Reading and writing files so that a failure says which file, and never leaves half of one."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

from hil.core.errors import BadInputError


def read_text(path: Path) -> str:
    """Text of a UTF-8 file; BadInputError tells why it cannot be read."""
    try:
        return path.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise BadInputError("not a UTF-8 text file", where=str(path)) from error
    except OSError as error:
        raise BadInputError(
            _reason(error), where=str(path), fix="check the path and its permissions"
        ) from error


def write_atomically(path: Path, content: str | bytes) -> None:
    """Write the whole file or none of it."""
    with replacing(path) as temporary:
        temporary.write_bytes(content.encode() if isinstance(content, str) else content)


@contextlib.contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A temporary path beside `path` that takes its place when the block ends well.

    Raises:
        BadInputError: the directory cannot be written or the disk is full.
    """
    temporary: Path | None = None
    try:
        make_directory(path.parent)
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.stem}.", suffix=path.suffix)
        os.close(handle)
        temporary = Path(name)
        yield temporary
        temporary.chmod(0o644)
        temporary.replace(path)
    except OSError as error:
        raise BadInputError(
            f"cannot be written: {_reason(error)}", where=str(path), fix="choose another place with --out"
        ) from error
    finally:
        if temporary is not None:
            temporary.unlink(missing_ok=True)


def make_directory(path: Path) -> None:
    """Make a directory and its parents; BadInputError if that cannot be done."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise BadInputError(
            f"cannot be made a directory: {_reason(error)}",
            where=str(path),
            fix="choose another place with --out",
        ) from error


def _reason(error: OSError) -> str:
    return error.strerror or str(error)
