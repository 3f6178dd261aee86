"""A serial line that may go away and come back, as an adapter does that is plugged in again."""

from __future__ import annotations

from drivers.serial_line import SerialLine
from hil.core.errors import BenchError
from hil.core.runtime.clock import Clock

_AGAIN_S = 0.5


class ReturningLine:
    """A `SerialLine` that is opened anew, twice a second, while it is away.

    Raises:
        BenchError: it is not there to begin with.
    """

    def __init__(self, name: str, url: str, baud_rate: int, clock: Clock) -> None:
        self.name = name
        self._url, self._baud_rate, self._clock = url, baud_rate, clock
        self._line: SerialLine | None = SerialLine(name, url, baud_rate)
        self._tried_s = 0.0
        self.gone = ""  # why, while it is away

    def send(self, data: bytes) -> bool:
        """Write bytes; False if the line is away."""
        if self._line is not None:
            try:
                self._line.send(data)
                return True
            except BenchError as error:
                self._lose(error)
        return False

    def drain(self) -> bytes:
        """Every byte that came since the last call; none while the line is away."""
        if self._line is None:
            self._try_again()
        if self._line is not None:
            try:
                return self._line.drain()
            except BenchError as error:
                self._lose(error)
        return b""

    def close(self) -> None:
        """Let go of the port."""
        if self._line is not None:
            self._line.close()

    def _lose(self, error: BenchError) -> None:
        self.close()
        self._line, self.gone, self._tried_s = None, error.what, self._clock.now_s()

    def _try_again(self) -> None:
        now_s = self._clock.now_s()
        if now_s - self._tried_s < _AGAIN_S:
            return
        self._tried_s = now_s
        try:
            self._line, self.gone = SerialLine(self.name, self._url, self._baud_rate), ""
        except BenchError as error:
            self.gone = error.what
