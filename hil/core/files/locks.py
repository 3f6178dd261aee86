"""Locks that the kernel drops with their process, however it ends; and who holds one."""

from __future__ import annotations

import contextlib
import os
import re
import stat
import tempfile
from collections.abc import Iterator
from pathlib import Path

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

_KERNELS_LIST = Path("/proc/locks")
#: Where locks of things that are no files lie: for all users of the machine, gone when it starts anew.
_SHARED_PLACES = (Path("/run/lock"), Path("/var/lock"), Path("/tmp"))
_LONGEST_COMMAND = 120


class HeldError(Exception):
    """Another process holds the lock; its text names the process as far as the system tells."""


@contextlib.contextmanager
def lock_on(path: Path, *, shared: bool = False) -> Iterator[int]:
    """Hold a lock on a directory or file that is there; it leaves nothing behind.

    Args:
        shared: others may hold it too that share it.

    Yields:
        the descriptor that holds it.

    Raises:
        HeldError: another process holds it.
        OSError: the path cannot be opened.
    """
    handle = os.open(path, os.O_RDONLY)
    try:
        if fcntl is not None:
            try:
                fcntl.flock(handle, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
            except BlockingIOError:
                raise HeldError(_holder(handle)) from None
            except OSError:
                pass  # a file system without locks
        yield handle
    finally:
        os.close(handle)


@contextlib.contextmanager
def lock_named(name: str, *, shared: bool = False) -> Iterator[None]:
    """Hold a lock on something that is no file, for all processes of this machine.

    A file named by it is locked. It stays after a kill, and where it is shared, and holds no one up: only the
    lock counts.

    Args:
        shared: others may hold it too that share it.

    Raises:
        HeldError: another process holds it.
        OSError: the file cannot be made.
    """
    path = shared_place() / f"eaxle-hil-{re.sub('[^A-Za-z0-9.-]+', '_', name)[:100]}.lock"
    with contextlib.ExitStack() as held:
        while not _has_name(path, held, shared=shared):
            held.close()
        try:
            yield
        finally:
            if not shared:  # another may hold it still
                with contextlib.suppress(OSError):  # another user's file
                    path.unlink()


def _has_name(path: Path, held: contextlib.ExitStack, *, shared: bool) -> bool:
    """Lock the file; whether it is still the one of this name: its holder takes it away when it is done."""
    with contextlib.suppress(FileExistsError):
        made = os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o644)
        with contextlib.suppress(OSError):
            path.chmod(0o644)  # whatever the umask: another account has to be able to look at it
        os.close(made)
    with contextlib.suppress(FileNotFoundError):
        handle = held.enter_context(lock_on(path, shared=shared))
        return os.path.samestat(os.fstat(handle), path.stat())
    return False


def shared_place() -> Path:
    """Where files of `lock_named` lie."""
    for place in _SHARED_PLACES:
        with contextlib.suppress(OSError):
            if place.stat().st_mode & stat.S_IWOTH:  # else another account would take another place
                return place
    return Path(tempfile.gettempdir())


def _holder(handle: int) -> str:
    """Which process holds the lock of a file: its number and its command, as far as the system tells."""
    inode = str(os.fstat(handle).st_ino)
    try:
        lines = [line.split() for line in _KERNELS_LIST.read_text().splitlines()]
    except OSError:
        return "another process"
    # NUMBER: FLOCK ADVISORY WRITE PROCESS DEVICE:INODE 0 EOF; who waits has a -> before FLOCK
    for fields in lines:
        if fields[1:2] == ["FLOCK"] and fields[5].rpartition(":")[2] == inode and fields[4].isdecimal():
            return process_in_words(int(fields[4]))
    return "another process"


def process_in_words(number: int) -> str:
    """A process by its number and command line."""
    try:
        command = Path(f"/proc/{number}/cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace")
    except OSError:
        return f"process {number}"
    return f"process {number} ({command.strip()[:_LONGEST_COMMAND]})"
