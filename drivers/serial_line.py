"""A serial line as devices see it: write, take what has come, never wait."""

from __future__ import annotations

import io
import select
from typing import Any

from hil.core.errors import BenchError
from hil.core.errors.wording import printable

_ROOM_WITHIN_S = 0.005


class SerialLine:
    """One port, opened by pyserial, used from one thread: `BusLoop.serve` hands out what comes.

    What pyserial raises are OSErrors.

    Args:
        name: of the device, for messages.
        url: what pyserial opens: "/dev/ttyUSB0", "COM3", "rfc2217://…".
        baud_rate: bit/s.

    Raises:
        BenchError: the port cannot be opened.
    """

    def __init__(self, name: str, url: str, baud_rate: int = 115_200) -> None:
        self.name = name
        self._url = url
        import serial  # here: benches without a serial line start without it

        try:
            self._port = serial.serial_for_url(url, baudrate=baud_rate, timeout=0, write_timeout=0)
        except (ValueError, OSError) as error:
            raise self._failed("cannot be opened", error) from error

    def send(self, data: bytes) -> None:
        """Write bytes.

        Raises:
            BenchError: the port does not take them (unplugged, queue full).
        """
        try:
            written = written_at_once(self._port, data)
        except OSError as error:
            raise self._failed("sending failed", error) from error
        if written != len(data):
            raise self._failed("sending failed", f"{written} of {len(data)} bytes were taken")

    def drain(self) -> bytes:
        """Every byte that came since the last call.

        Raises:
            BenchError: the port is gone.
        """
        try:
            return bytes(self._port.read(max(1, self._port.in_waiting)))
        except (OSError, TypeError) as error:  # TypeError: closed meanwhile
            raise self._failed("receiving failed", error) from error

    def close(self) -> None:
        """Let go of the port."""
        self._port.close()

    def _failed(self, what: str, error: object) -> BenchError:
        return BenchError(
            f"{what}: {printable(str(error), 200)}",
            where=f"device '{self.name}' ({printable(self._url, 80)})",
            fix="check its table in the bench file, the adapter and its cable",
        )


def written_at_once(port: Any, data: bytes) -> int:
    """How many bytes a pyserial port with `write_timeout` 0 takes now; 5 ms at most are waited.

    pyserial itself tries for ever when a line takes nothing; with a time-out it raises one for what it has
    written whenever the machine was busy meanwhile.

    Raises:
        OSError: the port is gone.
    """
    try:
        descriptor = port.fileno()
    except (AttributeError, io.UnsupportedOperation):  # Windows, a network: these do not try for ever
        return int(port.write(data))
    if not select.select([], [descriptor], [], _ROOM_WITHIN_S)[1]:
        return 0
    return int(port.write(data))
