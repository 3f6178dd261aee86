"""A bus that is only listened to."""

from __future__ import annotations

from drivers.wire import Wire
from hil.core.errors import BenchError


class ListeningWire(Wire):
    """A `Wire` that sends nothing, whoever asks it to."""

    def send(self, frame_id: int, data: bytes) -> None:
        """Raises:
        BenchError: always.
        """
        del data
        what = f"0x{frame_id:03X} was to be sent on a bus that is only listened to"
        raise BenchError(what, where=f"bus '{self.name}'")
