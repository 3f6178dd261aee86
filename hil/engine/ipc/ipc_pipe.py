"""Messages over two pipes without ever waiting: what cannot be written now waits its turn, not the loop."""

from __future__ import annotations

import contextlib
import os
import select
import threading
import time

from hil.engine.ipc.ipc_messages import Message, from_line, to_line

#: What waits for a reader that does not read: enough for any outcome, and for a minute of log.
MOST_WAITING_BYTES = 1 << 22
_AT_ONCE = 1 << 16


class IpcPipe:
    """One end: reads from one descriptor, writes to another; both are closed with it.

    `gone`: the other end has closed, or its process has ended.
    """

    def __init__(self, reading: int, writing: int) -> None:
        self.reading, self._writing = reading, writing
        for descriptor in (reading, writing):
            os.set_blocking(descriptor, False)
        self._waiting, self._begun = bytearray(), bytearray()
        self._lock = threading.RLock()  # lines of the log come from any thread
        self.gone = False

    def send(self, message: Message) -> None:
        """Write a message, or keep it until `push`."""
        with self._lock:
            self._waiting += to_line(message)
        self.push()

    def send_if_idle(self, message: Message) -> None:
        """Write a message that is worth nothing later: not while others wait."""
        if self._waiting:
            self.push()
        else:
            self.send(message)

    @property
    def crowded(self) -> bool:
        """Whether so much waits that what is not needed had better be left out."""
        return len(self._waiting) > MOST_WAITING_BYTES

    def push(self) -> None:
        """Write what waits, as far as that goes now."""
        with self._lock:
            while self._waiting and not self.gone:
                try:
                    written = os.write(self._writing, bytes(self._waiting[:_AT_ONCE]))
                except BlockingIOError:
                    return
                except OSError:  # no one reads any more
                    self.gone = True
                    return
                del self._waiting[:written]

    def push_all(self, within_s: float) -> bool:
        """Write all that waits; false if the other end did not take it in time."""
        until_s = time.monotonic() + within_s
        while True:
            self.push()
            left_s = until_s - time.monotonic()
            if self.gone or not self._waiting or left_s <= 0:
                return not self._waiting
            select.select([], [self._writing], [], left_s)

    def fetch(self) -> list[Message]:
        """What has come since the last call.

        Raises:
            BenchError: something that is no message.
        """
        with contextlib.suppress(BlockingIOError):
            while data := self._read():
                self._begun += data
        *lines, rest = self._begun.split(b"\n")
        self._begun = rest
        return [from_line(bytes(line)) for line in lines]

    def wait(self, for_s: float) -> None:
        """Return when something has come, at the latest after a time."""
        with contextlib.suppress(OSError, ValueError):
            select.select([self.reading], [], [], for_s)

    def close(self) -> None:
        """Close both directions."""
        for descriptor in {self.reading, self._writing}:
            with contextlib.suppress(OSError):
                os.close(descriptor)

    def _read(self) -> bytes:
        try:
            data = os.read(self.reading, _AT_ONCE)
        except BlockingIOError:
            raise
        except OSError:
            data = b""
        self.gone |= not data
        return data
