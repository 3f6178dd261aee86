"""The file that a recording grows in: whole writes, nothing held back, and safe from a power cut if asked."""

from __future__ import annotations

import contextlib
import logging
import os
import threading
import time
from pathlib import Path

logger = logging.getLogger(__name__)

#: How long data may lie with the operating system alone, s.
DURABLE_WITHIN_S = 0.25
_sync = getattr(os, "fdatasync", os.fsync)  # only Linux has the shorter one


class GrowingFile:
    """A file without a buffer of its own: after a full disk nothing is left that would be written later.

    A killed process loses nothing that was written; for a power cut the data must be on the disk itself.

    Args:
        durable: see to that every quarter of a second. A thread does it, for on a busy disk it takes longer
            than a device waits for its host; the thread knows nothing but the file.
    """

    def __init__(self, path: Path, *, durable: bool = False) -> None:
        self._raw = path.open("wb", buffering=0)
        self._failure: OSError | None = None
        self._whole = 0
        self._syncing = _Syncing(self._raw.fileno()) if durable else None

    def write(self, data: bytes | bytearray | memoryview) -> int:
        """Write all of it; what a failure left of it is taken back.

        Raises:
            OSError: it cannot be written, or what was written before did not reach the disk.
        """
        if self._syncing and self._syncing.failure:
            self._failure = self._failure or self._syncing.failure
        if self._failure is not None:
            raise self._failure
        rest = memoryview(data)
        try:
            while rest:
                rest = rest[self._raw.write(rest) :]
        except OSError as error:
            self._failure = error
            with contextlib.suppress(OSError):
                self._raw.truncate(self._whole)
            self.close()
            raise
        self._whole += len(data)
        return len(data)

    def tell(self) -> int:
        """Bytes so far."""
        return self._whole

    def close(self) -> None:
        """Put everything on the disk and let go of the file."""
        if self._raw.closed:
            return
        if self._syncing:
            self._syncing.end()
        with contextlib.suppress(OSError):  # of a full or broken disk it was told when it was written to
            _sync(self._raw.fileno())
        self._raw.close()


class _Syncing:
    """A thread that makes a growing file durable again and again."""

    def __init__(self, descriptor: int) -> None:
        self.failure: OSError | None = None
        self.longest_s = 0.0
        self._descriptor = os.dup(descriptor)  # stays that of this file whatever becomes of the other
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._work, name="recording to disk", daemon=True)
        self._thread.start()

    def end(self) -> None:
        """Return when the thread has ended."""
        self._over.set()
        self._thread.join()
        os.close(self._descriptor)
        logger.info("the longest sync of the recording took %.0f ms", 1e3 * self.longest_s)

    def _work(self) -> None:
        while not self._over.wait(DURABLE_WITHIN_S):
            began_s = time.monotonic()
            try:
                _sync(self._descriptor)
            except OSError as error:
                self.failure = error
                return
            self.longest_s = max(self.longest_s, time.monotonic() - began_s)
