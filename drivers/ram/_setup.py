"""Sets a slave's DAQ list up: what is requested, written and read back before its samples are believed."""

from __future__ import annotations

from collections.abc import Sequence

from drivers.ram._decoder import DaqDecoder, Odt, packed
from drivers.ram._master import Master
from hil.core.can.symbols import Symbol, Symbols
from hil.core.can.xcp import (
    DYNAMIC,
    IDENTIFICATION_FIELD,
    LARGEST_ODT_NUMBER,
    LIST_RUNNING,
    LIST_TIME_STAMPED,
    LOCKED_DAQ,
    MOST_BYTES,
    PRESCALER,
    SELECT,
    START_SELECTED,
    STOP_ALL,
    TIME_STAMPS,
    WHOLE_ENTRY,
    Command,
    TimeStamps,
    connected,
    period_s,
    time_stamps,
)
from hil.core.errors import BenchError

_LIST = 0


class Setup:
    """One DAQ list of a slave.

    Args:
        symbols: what is measured, in this order.
        file: what else their file says.
        event, every: of the slave's event channel each such sample.
        event_period_s: distance of the event's samples.
    """

    def __init__(
        self,
        master: Master,
        symbols: Sequence[Symbol],
        file: Symbols,
        event: int,
        every: int,
        event_period_s: float,
    ) -> None:
        self._master, self._symbols, self._file = master, symbols, file
        self._event, self._every, self._event_period_s = event, every, event_period_s
        self._packet = MOST_BYTES

    def connect(self) -> None:
        """Begin a session.

        Raises:
            BenchError: no answer, or it cannot measure.
        """
        answer = self._master.ask(Command.CONNECT, "B", 0)
        if len(answer) < MOST_BYTES:
            raise self._master.failed(f"answers to CONNECT with {len(answer)} bytes only")
        found = connected(answer)
        self._master.order = found.order
        self._master.largest_command = max(2, min(found.most_in_command, MOST_BYTES))
        self._packet = min(found.most_in_data, MOST_BYTES)
        if not found.measures:
            raise self._master.failed("has no DAQ lists: it cannot measure by itself")
        if found.bytes_each != 1:
            raise self._master.failed(
                f"its addresses are of {found.bytes_each} bytes each; only bytes are known"
            )

    def status(self) -> int:
        """Its session status.

        Raises:
            BenchError: no answer, or its measuring is locked.
        """
        status, protected = self._master.read(self._master.ask(Command.GET_STATUS), "BB")
        if protected & LOCKED_DAQ:
            raise self._master.failed(
                "its measurement is locked by seed and key",
                "unlock it with the manufacturer's tool",
            )
        return int(status)

    def arrange(self) -> DaqDecoder:
        """See that the file is of this software, and set the list up; what reads its samples.

        Raises:
            BenchError: a refusal, another software, or an event that comes at another pace.
        """
        self._refuse_other_software()
        ask = self._master.ask
        ask(Command.START_STOP_SYNCH, "B", STOP_ALL)
        stamps, odts, dynamic = self._arranged()
        if dynamic:
            self._allocate(odts)
        else:
            self._refuse_small_list(odts)
        for number, odt in enumerate(odts):
            ask(Command.SET_DAQ_PTR, "xHBB", _LIST, number, 0)
            for entry in odt:
                ask(Command.WRITE_DAQ, "BBBI", WHOLE_ENTRY, entry.size, entry.extension, entry.address)
        ask(Command.SET_DAQ_LIST_MODE, "BHHBB", LIST_TIME_STAMPED, _LIST, self._event, self._every, 0)
        (first,) = self._master.read(ask(Command.START_STOP_DAQ_LIST, "BH", SELECT, _LIST), "B")
        if first + len(odts) - 1 > LARGEST_ODT_NUMBER:
            raise self._master.failed(f"numbers its first ODT {first}: {len(odts)} have no room behind it")
        every_s = self._every * self._event_period_s
        return DaqDecoder(first, odts, self._symbols, stamps, self._master.order, every_s)

    def start(self) -> None:
        """Let the list run, and read back that it does.

        Raises:
            BenchError: a refusal, or it is set to something else than was written.
        """
        self._master.ask(Command.START_STOP_SYNCH, "B", START_SELECTED)
        says, event, every, _ = self._master.read(
            self._master.ask(Command.GET_DAQ_LIST_MODE, "xH", _LIST), "BxxHBB"
        )
        if not says & LIST_RUNNING:
            raise self._master.failed("its list does not run though it was started")
        if (event, every) != (self._event, self._every):
            raise self._master.failed(
                f"its list reads back as event {event}, every {every}; "
                f"{self._event} and {self._every} were written"
            )

    def software(self) -> str:
        """What the memory says where the file says that the software's name stands."""
        if self._file.software_address is None:
            return ""
        data = self._master.memory(self._file.software_address, len(self._file.software.encode()))
        return data.decode("ascii", errors="replace").rstrip("\0 ")

    def _refuse_other_software(self) -> None:
        """Addresses of another software are other variables."""
        self.status()
        found = self.software()
        if self._file.software_address is not None and found != self._file.software:
            raise self._master.failed(
                f"its software is '{found}', the symbols are of '{self._file.software}'",
                "give the file that belongs to this software",
            )

    def _arranged(self) -> tuple[TimeStamps, list[Odt], bool]:
        """How time is stamped, what stands in each packet, and whether lists are allocated."""
        ask, read, failed = self._master.ask, self._master.read, self._master.failed
        properties, _, events, _, key = read(ask(Command.GET_DAQ_PROCESSOR_INFO), "BHHBB")
        if key & IDENTIFICATION_FIELD:
            raise failed("its packets are not numbered by absolute ODT numbers, which is the only way known")
        if not properties & TIME_STAMPS:
            raise failed("gives its samples no time stamps, so lost samples cannot be detected")
        if self._every > 1 and not properties & PRESCALER:
            raise failed("cannot skip samples", "write every = 1, and measure fewer symbols")
        if events and self._event >= events:
            raise failed(f"has no event channel {self._event}, only 0 to {events - 1}", "correct 'event'")
        granularity, most, _, _, mode, ticks = read(ask(Command.GET_DAQ_RESOLUTION_INFO), "BBBBBH")
        try:
            stamps = time_stamps(mode, ticks)
            _, _, _, cycle, unit, _ = read(ask(Command.GET_DAQ_EVENT_INFO, "xH", self._event), "BBBBBB")
            its_period_s = period_s(cycle, unit)
        except ValueError as error:
            raise failed(f"reports invalid properties: {error}") from None
        if not stamps.size or not stamps.tick_s:
            raise failed("gives its samples no time stamps, so lost samples cannot be detected")
        if its_period_s and abs(its_period_s - self._event_period_s) > 1e-3 * self._event_period_s:
            raise failed(
                f"its event channel {self._event} comes every {its_period_s * 1e3:g} ms, "
                f"the bench file says {self._event_period_s * 1e3:g} ms",
                f"write event_period_s = {its_period_s:g}",
            )
        try:
            odts = packed(self._symbols, stamps.size, self._packet, max(1, granularity), max(1, most))
        except BenchError as error:
            raise failed(error.what, "measure other symbols") from None
        return stamps, odts, bool(properties & DYNAMIC)

    def _allocate(self, odts: Sequence[Odt]) -> None:
        ask = self._master.ask
        ask(Command.FREE_DAQ)
        ask(Command.ALLOC_DAQ, "xH", 1)
        ask(Command.ALLOC_ODT, "xHB", _LIST, len(odts))
        for number, odt in enumerate(odts):
            ask(Command.ALLOC_ODT_ENTRY, "xHBB", _LIST, number, len(odt))

    def _refuse_small_list(self, odts: Sequence[Odt]) -> None:
        """A slave with lists of its own: the first one is used."""
        ask, read = self._master.ask, self._master.read
        ask(Command.CLEAR_DAQ_LIST, "xH", _LIST)
        _, most, entries = read(ask(Command.GET_DAQ_LIST_INFO, "xH", _LIST), "BBB")
        if len(odts) > most or max(map(len, odts)) > entries:
            raise self._master.failed(
                f"its list {_LIST} has {most} ODTs of {entries} entries; "
                f"{len(odts)} of {max(map(len, odts))} are wanted",
                "measure fewer symbols",
            )
