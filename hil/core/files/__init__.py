"""Reading and writing files so that a failure says which file, and never leaves half of one."""

from __future__ import annotations

import contextlib
import errno
import hashlib
import os
import secrets
import shutil
import stat
from collections.abc import Iterator
from io import BufferedReader
from pathlib import Path

from hil.core.errors import BadInputError, BenchError, HilError

_CHECK_PATH = "check the path and its permissions"
_DISK_FAILURES = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)


#: Of a file that is read at once, unless its reader knows better: results, manifests, lists.
LARGEST_BYTES = 64_000_000
_KINDS = {
    stat.S_IFDIR: "a directory",
    stat.S_IFIFO: "a pipe",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
    stat.S_IFSOCK: "a socket",
}


def is_file(path: Path) -> bool:
    """Whether there is such a file; a name that no file can have is none."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def refuse_unless_regular(path: Path, fix: str = "") -> None:
    """Refuse what is no regular file; nothing is opened, so that a pipe cannot block.

    Raises:
        BadInputError: there is no such file, or it is a directory, a pipe, a device or a socket.
    """
    try:
        mode = path.stat().st_mode
    except ValueError as error:
        raise BadInputError(f"not a path: {error}", where=repr(str(path)), fix=fix) from error
    except OSError as error:
        reason = _reason(error)
        if path.is_symlink() and not path.exists():
            reason = f"{reason}: it is a link to {os.fspath(path.readlink())!r}"
        raise BadInputError(reason, where=str(path), fix=fix or _CHECK_PATH) from error
    if not stat.S_ISREG(mode):
        kind = _KINDS.get(stat.S_IFMT(mode), "a special file")
        raise BadInputError(f"is {kind}, not a file", where=str(path), fix=fix or "give a regular file")


def open_regular(path: Path, fix: str = "") -> BufferedReader:
    """The file, opened for reading.

    Raises:
        BadInputError: there is none, it may not be read, or it is not a regular file; with `fix`.
    """
    refuse_unless_regular(path, fix)
    try:
        return path.open("rb")
    except OSError as error:
        raise BadInputError(_reason(error), where=str(path), fix=fix or _CHECK_PATH) from error


def read_bytes(path: Path, at_most: int = LARGEST_BYTES, fix: str = "") -> bytes:
    """Content of a regular file of `at_most` bytes; no more than these are ever held.

    Raises:
        BadInputError: it cannot be read, is no regular file, or is larger; with `fix`.
    """
    try:
        with open_regular(path, fix) as file:
            content = file.read(at_most + 1)
    except OSError as error:
        raise BadInputError(_reason(error), where=str(path), fix=fix or _CHECK_PATH) from error
    if len(content) > at_most:
        raise BadInputError(
            f"has more than {at_most / 1e6:g} MB, too much for a file of this kind",
            where=str(path),
            fix=fix or "check that it is the right file",
        )
    return content


def read_text(path: Path, at_most: int = LARGEST_BYTES, fix: str = "") -> str:
    """Text of a regular UTF-8 file of `at_most` bytes.

    Raises:
        BadInputError: it cannot be read, is no regular file, is larger, or not UTF-8.
    """
    try:
        return read_bytes(path, at_most, fix).decode("utf-8").replace("\r\n", "\n").replace("\r", "\n")
    except UnicodeDecodeError as error:
        raise BadInputError("not a UTF-8 text file", where=str(path), fix=fix) from error


def sha256_of(path: Path) -> str:
    """SHA-256 of a file, hexadecimal.

    Raises:
        BadInputError: it cannot be read.
    """
    try:
        with open_regular(path) as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        raise BadInputError(_reason(error), where=str(path), fix=_CHECK_PATH) from error


def write_atomically(path: Path, content: str | bytes) -> None:
    """Write the whole file or none of it."""
    with replacing(path) as temporary:
        temporary.write_bytes(content.encode() if isinstance(content, str) else content)


@contextlib.contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A temporary path beside `path` that takes its place when the block ends well.

    Raises:
        BadInputError: the place cannot be written.
        BenchError: the disk is full or broken.
    """
    refuse_special(path)
    temporary = path.with_name(f".{path.stem[:40]}.{secrets.token_hex(6)}{path.suffix}")
    try:
        make_directory(path.parent)
        yield temporary
        _put_on_disk(temporary)
        temporary.chmod(0o644)
        temporary.replace(path)
    except OSError as error:
        raise _unwritable(path, error) from error
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)


def _put_on_disk(path: Path) -> None:
    """Else a power cut after the renaming could leave an empty file in the place of the earlier one."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def disk_of(path: Path) -> str:
    """The disk that a path lies on, in words: where it is mounted, and what of it is free."""
    place = path.resolve()
    while not place.is_mount() and place != place.parent:
        place = place.parent
    with contextlib.suppress(OSError):
        room = shutil.disk_usage(place)
        return f"disk at {place}, {room.free / 1e6:.1f} of {room.total / 1e6:.0f} MB free"
    return f"disk at {place}"


def full_disk_in_words(error: OSError, path: Path) -> str:
    """Why a file could not be written; of a full or broken disk also which."""
    return f"{_reason(error)} ({disk_of(path)})" if error.errno in _DISK_FAILURES else _reason(error)


def refuse_special(path: Path) -> None:
    """Refuse to put a file in the place of a directory or a device.

    Raises:
        BadInputError: something that is no regular file stands there.
    """
    with contextlib.suppress(OSError):
        if path.is_symlink() and not path.exists():
            raise BadInputError(
                "is a link to a missing file", where=str(path), fix="remove or correct the link"
            )
        if path.exists() and not path.is_file():
            what = "is a directory" if path.is_dir() else "is not a regular file"
            raise BadInputError(what, where=str(path), fix="name a file, not a directory")


def make_directory(path: Path, *, option: str = "--out") -> None:
    """Make a directory and its parents; BadInputError with the option that named it if it cannot be done."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise BadInputError(
            f"cannot be made a directory: {_reason(error)}",
            where=str(path),
            fix=f"choose another place with {option}",
        ) from error


def of_the_system(error: OSError) -> HilError:
    """What the operating system refused, in our words: a full or broken disk is no mistake of the user's."""
    kind = BenchError if error.errno in _DISK_FAILURES else BadInputError
    return kind(
        _reason(error), where=str(error.filename or ""), fix="check the path, its permissions and the disk"
    )


def _unwritable(path: Path, error: OSError) -> HilError:
    if error.errno in _DISK_FAILURES:
        return BenchError(
            f"cannot be written: {full_disk_in_words(error, path)}",
            where=str(path),
            fix="free disk space, then try again",
        )
    return BadInputError(
        f"cannot be written: {_reason(error)}", where=str(path), fix="choose another place with --out"
    )


def _reason(error: OSError) -> str:
    return error.strerror or str(error)


_LARGEST_BYTES = 20_000_000  # the largest vehicle's DBC has a tenth of this


def read_device_text(path: Path, fix: str) -> str:
    """Text of a file in UTF-8 or in Windows' code page, which most such tools write.

    Raises:
        BadInputError: it is missing, no regular file, cannot be read, or too large to be a description; with
            `fix`.
    """
    content = read_bytes(path, _LARGEST_BYTES, fix)
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("cp1252", errors="replace")
