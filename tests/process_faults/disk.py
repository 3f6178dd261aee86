"""Whether the machine's disk stood still: another file on it is written and synced all the time."""

from __future__ import annotations

import os
import threading
import time
from pathlib import Path

_EVERY_S = 0.1
_BYTES = 4096


class DiskWatch:
    """Writes a file until it is closed, and knows for how long it was kept waiting at most.

    `longest_s` is of a write and a sync together; of a piece that is under way when it is closed as well.
    """

    def __init__(self, path: Path) -> None:
        self.longest_s = 0.0
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._write, args=(path,))
        self._thread.start()

    def close(self) -> None:
        self._over.set()
        self._thread.join()

    def _write(self, path: Path) -> None:
        with path.open("wb", buffering=0) as file:
            while not self._over.wait(_EVERY_S):
                began_s = time.monotonic()
                file.write(bytes(_BYTES))
                os.fdatasync(file.fileno())
                self.longest_s = max(self.longest_s, time.monotonic() - began_s)
