"""The asking side of XCP: one command at a time, each with a deadline and a bounded number of tries."""

from __future__ import annotations

import struct
from typing import Any

from drivers.loop import BusLoop
from drivers.wire import Wire
from hil.core.can.xcp import ANSWER, ERROR, EVENT, MOST_BYTES, Code, Command, Happened, in_words
from hil.core.errors import DeviceError
from hil.core.errors.wording import printable

_ATTEMPTS = 3
_BUSY_S, _LONGEST_BUSY_S = 0.05, 2.0
_LONGEST_TEXT = 255
_TEXT = 0  # of GET_ID
_IN_THE_ANSWER = 0x01


class Master:
    """Asks a slave on CAN. After a command without an answer both synchronise, so that no late one is taken.

    Attributes:
        order: "<" or ">", as the slave counts.
        events: what the slave sent unasked, by its code, and how often.
    """

    def __init__(self, name: str, loop: BusLoop, wire: Wire, request_id: int, within_s: float) -> None:
        self._where = f"device '{name}'"
        self._loop, self._wire, self._request_id, self._within_s = loop, wire, request_id, within_s
        self._awaits = False
        self._answer: bytes | None = None
        self._pending = False
        self.order = "<"
        self.largest_command = MOST_BYTES
        self.events: dict[int, int] = {}

    @property
    def awaits(self) -> bool:
        """Whether an answer is awaited by `ask` now."""
        return self._awaits

    def take(self, packet: bytes) -> None:
        """An answer, an error or an event has come."""
        if packet[0] in (ANSWER, ERROR):
            self._answer = packet
        elif packet[0] == EVENT and len(packet) > 1:
            self._pending |= packet[1] == Happened.CMD_PENDING
            self.events[packet[1]] = self.events.get(packet[1], 0) + 1

    def send(self, command: Command, arguments: bytes = b"") -> None:
        """Send a command and wait for nothing.

        Raises:
            DeviceError: the bus does not take it.
        """
        self._wire.send(self._request_id, (bytes([command]) + arguments).ljust(MOST_BYTES, b"\0"))

    def ask(self, command: Command, layout: str = "", *values: int) -> bytes:
        """One exchange: `values` as `struct` lays them out; the answer, its first byte included.

        Raises:
            DeviceError: no answer, or an error.
        """
        arguments = struct.pack(f"{self.order}{layout}", *values)
        busy_until_s = self._loop.clock.now_s() + _LONGEST_BUSY_S
        attempts = 0
        while attempts < _ATTEMPTS:
            answer = self._exchanged(command, arguments)
            if answer is None:
                attempts += 1
                if command not in (Command.CONNECT, Command.SYNCH):
                    self._exchanged(Command.SYNCH, b"")
            elif answer[0] == ANSWER:
                return answer
            elif len(answer) < 2 or answer[1] == Code.CMD_SYNCH:
                attempts += 1
            elif answer[1] == Code.CMD_BUSY and self._loop.clock.now_s() < busy_until_s:
                self._loop.run_for(_BUSY_S)
            else:
                raise self.failed(f"{command.name}: the slave {in_words(answer[1])}")
        raise self.failed(
            f"no answer to {command.name} in {_ATTEMPTS} attempts of {self._within_s:g} s",
            f"check the RMCU's power, the identifiers, and that its XCP is on bus '{self._wire.name}'",
        )

    def read(self, answer: bytes, layout: str) -> tuple[Any, ...]:
        """The numbers of an answer behind its first byte.

        Raises:
            DeviceError: it is too short.
        """
        try:
            return struct.unpack_from(f"{self.order}x{layout}", answer)
        except struct.error:
            raise self.failed(f"answers with {len(answer)} bytes only ({answer.hex(' ')})") from None

    def memory(self, address: int, count: int, extension: int = 0) -> bytes:
        """Bytes of the slave's memory.

        Raises:
            DeviceError: no answer, or it does not let them be read.
        """
        self.ask(Command.SET_MTA, "xxBI", extension, address)
        return self._uploaded(count)

    def own_name(self) -> str:
        """The text by which the slave names itself; '' if it has none.

        Raises:
            DeviceError: no answer.
        """
        answer = self.ask(Command.GET_ID, "B", _TEXT)
        mode, length = self.read(answer, "BxxI")
        count = min(length, _LONGEST_TEXT)
        data = answer[8 : 8 + count] if mode & _IN_THE_ANSWER else self._uploaded(count)
        return printable(data.decode("ascii", errors="replace").rstrip("\0 "), _LONGEST_TEXT)

    def failed(
        self, what: str, fix: str = "check the RMCU's XCP, and the file of its symbols"
    ) -> DeviceError:
        """An error of this device."""
        return DeviceError(what, where=self._where, fix=fix)

    def _uploaded(self, count: int) -> bytes:
        found = b""
        while len(found) < count:
            piece = min(count - len(found), self.largest_command - 1)
            data = self.ask(Command.UPLOAD, "B", piece)[1 : 1 + piece]
            if len(data) < piece:
                raise self.failed(f"UPLOAD: {piece} bytes were requested, {len(data)} received")
            found += data
        return found

    def _exchanged(self, command: Command, arguments: bytes) -> bytes | None:
        self._answer, self._awaits = None, True
        try:
            self.send(command, arguments)
            until_s = self._loop.clock.now_s() + _LONGEST_BUSY_S
            while True:
                self._pending = False
                self._loop.wait_for(lambda: self._answer is not None or self._pending, self._within_s)
                if not self._pending or self._answer is not None or self._loop.clock.now_s() > until_s:
                    return self._answer
        finally:
            self._awaits = False
