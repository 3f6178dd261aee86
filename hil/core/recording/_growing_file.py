"""The file that a recording grows in: whole writes, nothing held back, and safe from a power cut if asked."""

from __future__ import annotations

import contextlib
import errno
import logging
import os
import threading
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from queue import Empty, SimpleQueue

from hil.core.runtime.clock import as_this_thread

logger = logging.getLogger(__name__)

#: How long data may lie with the operating system alone, s.
DURABLE_WITHIN_S = 0.25
#: A disk that has been busy with one piece for longer than this takes nothing any more, s.
HANGS_AFTER_S = 5.0
_sync = getattr(os, "fdatasync", os.fsync)  # only Linux has the shorter one


class GrowingFile:
    """A file without a buffer of its own: after a full disk nothing is left that would be written later.

    A killed process loses nothing that was written; for a power cut the data must be on the disk itself.

    Args:
        durable: a thread writes, and sees every quarter of a second to that the disk has it. Both take longer
            than a device waits for its host while the disk is busy: a write waits for a sync of its file.
            The thread knows nothing but the file. A killed process loses what the disk did not take yet.
    """

    def __init__(self, path: Path, *, durable: bool = False) -> None:
        self._raw = path.open("wb", buffering=0)
        self._failure: OSError | None = None
        self._whole = 0
        self._thread = _WritingThread(self._put, self._raw.fileno()) if durable else None

    def write(self, data: bytes | bytearray | memoryview) -> int:
        """Write all of it; what a failure left of it is taken back.

        Raises:
            OSError: it cannot be written, or what was written before did not reach the disk.
        """
        if self._thread:
            self._failure = self._failure or self._thread.failure
        if self._failure is not None:
            raise self._failure
        if self._thread:
            self._thread.take(bytes(data))
        else:
            try:
                self._put(data)
            except OSError as error:
                self._failure = error
                self.close()
                raise
        self._whole += len(data)
        return len(data)

    def tell(self) -> int:
        """Bytes so far."""
        return self._whole

    def settle(self) -> None:
        """Return when whoever reads the file finds all of it there, or it has failed."""
        if self._thread:
            self._thread.settle()

    def close(self) -> None:
        """Put everything on the disk and let go of the file.

        Raises:
            OSError: what was written last could not be.
        """
        if self._raw.closed:
            return
        if self._thread:
            self._thread.end()
        with contextlib.suppress(OSError):  # a full or broken disk was reported when it was written to
            _sync(self._raw.fileno())
        self._raw.close()
        if self._failure is None and self._thread and self._thread.failure:
            self._failure = self._thread.failure
            raise self._failure

    def _put(self, data: bytes | bytearray | memoryview) -> None:
        whole, rest = os.fstat(self._raw.fileno()).st_size, memoryview(data)
        try:
            while rest:
                rest = rest[self._raw.write(rest) :]
        except OSError:
            with contextlib.suppress(OSError):
                self._raw.truncate(whole)
            raise


class _WritingThread:
    """Writes what it is given, in that order, and makes it durable again and again; nothing after a failure.

    It has the priority of the thread that made it: who holds the interpreter's lock is waited for by all.
    """

    def __init__(self, put: Callable[[bytes], None], descriptor: int) -> None:
        self._put = put
        self._descriptor = os.dup(descriptor)  # stays that of this file whatever becomes of the other
        self._given: SimpleQueue[bytes | threading.Event | None] = SimpleQueue()
        self._failed: OSError | None = None
        self._busy_since_s: float | None = None
        self._longest_s = {"write": 0.0, "sync": 0.0}
        self._thread = threading.Thread(
            target=self._work, args=(as_this_thread(),), name="recording to disk", daemon=True
        )
        self._thread.start()

    @property
    def failure(self) -> OSError | None:
        """What went wrong so far, or takes longer than any disk that works."""
        since_s = self._busy_since_s
        if self._failed is None and since_s is not None and time.monotonic() - since_s > HANGS_AFTER_S:
            return OSError(errno.ETIMEDOUT, f"the disk has taken nothing for {HANGS_AFTER_S:g} s")
        return self._failed

    def take(self, data: bytes) -> None:
        """Write it, without anybody waiting for that."""
        self._given.put(data)

    def settle(self) -> None:
        """Return when all that was given before is in the file, or cannot be."""
        written = threading.Event()
        self._given.put(written)
        written.wait()

    def end(self) -> None:
        """Return when the thread has ended."""
        self._given.put(None)
        self._thread.join()
        os.close(self._descriptor)
        longest = [f"{what} {1e3 * longest_s:.0f} ms" for what, longest_s in self._longest_s.items()]
        logger.info("the recording's disk took at most: %s", ", ".join(longest))

    def _work(self, as_who_made_it: Callable[[], None]) -> None:
        as_who_made_it()
        synced_s, unsynced = time.monotonic(), False
        while True:
            left_s = synced_s + DURABLE_WITHIN_S - time.monotonic()
            if unsynced and left_s <= 0.0:
                self._do("sync", partial(_sync, self._descriptor))
                synced_s, unsynced = time.monotonic(), False
            try:
                given = self._given.get(timeout=max(0.0, left_s) if unsynced else None)
            except Empty:
                continue
            if given is None:
                return
            if isinstance(given, threading.Event):
                given.set()
            else:
                self._do("write", partial(self._put, given))
                unsynced = True

    def _do(self, what: str, work: Callable[[], None]) -> None:
        if self._failed is not None:
            return
        self._busy_since_s = began_s = time.monotonic()
        try:
            work()
        except OSError as error:
            self._failed = error
        self._busy_since_s = None
        self._longest_s[what] = max(self._longest_s[what], time.monotonic() - began_s)
