"""The monitor of the RMCU's memory: a `Device` that has things measured, and takes the samples."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from drivers.device import Examined, Finding
from drivers.loop import BusLoop
from drivers.ram._decoder import DaqDecoder, Measured, packed
from drivers.ram._master import Master
from drivers.ram._setup import Setup
from drivers.samples import Counting, Samples, Stream
from drivers.wire import Wire
from hil.core.can.frames import SENT_BY_HOST, FrameBlock, standard
from hil.core.can.symbols import Symbol, Symbols
from hil.core.can.xcp import (
    DAQ_RUNNING,
    ERROR,
    LARGEST_ODT_NUMBER,
    MOST_BYTES,
    Command,
    Happened,
    TimeStamps,
    in_words,
)
from hil.core.errors import BenchError, DeviceError

_FIRST_SAMPLE_S = 0.5
_UNANSWERED_S = 1.8  # three beats and a little
_MOST_LOST = 0.1  # share of samples
_NEVER_TURNS = 1 << 40  # counts are without turns already
_EXPECTED = TimeStamps(2, 1e-4, False)  # until the slave has stated what it sends


class RamMonitor:
    """Measures symbols at an event of the RMCU. It moves nothing, and changes nothing but what is measured.

    Args:
        ids: identifiers of what is asked, and of answers and samples.
        channels: the symbol of each channel.
        file: what else the file of symbols says.
        event, every: of the slave's event channel each such sample.
    """

    heartbeat_s = 0.5  # how often it is asked for its status while it measures
    safe_within_s = 0.5

    def __init__(
        self,
        name: str,
        loop: BusLoop,
        wire: Wire,
        ids: tuple[int, int],
        channels: Mapping[str, Symbol],
        file: Symbols,
        event: int = 0,
        every: int = 1,
        event_period_s: float = 1e-3,
        answers_within_s: float = 0.2,
    ) -> None:
        self.name = name
        self._loop, self._wire, self._answer_id, self._file = loop, wire, ids[1], file
        symbols = list(channels.values())
        period_s = every * event_period_s
        self._master = Master(name, loop, wire, ids[0], answers_within_s)
        self._setup = Setup(self._master, symbols, file, event, every, event_period_s)
        self._stream = Stream(
            label=f"frame 0x{ids[1]:03X} ({next(iter(channels))})",
            where=f"bus '{wire.name}'",
            channels=tuple(channels),
            units=tuple(symbol.unit for symbol in symbols),
            period_s=period_s,
            silence_s=max(0.1, 5 * period_s),
            counting=Counting("time stamps of its DAQ list", _NEVER_TURNS),
        )
        self._measured = Measured(self._stream)
        self.sources = (self._measured,)
        odts = packed(symbols, _EXPECTED.size, MOST_BYTES, 1, MOST_BYTES)
        self._decoder = DaqDecoder(0, odts, symbols, _EXPECTED, file.order or "<", period_s)
        self._in_session = self._measuring = False
        self._said = ""
        self._asked_s: float | None = None
        loop.on_block(self._take)

    def come_up(self) -> None:
        """Connect, set its list up, start it, and see the first sample.

        Raises:
            BenchError: no answer, a refusal, another software than that of the symbols, or no samples.
        """
        self._measuring = False
        self._connect()
        self._decoder = self._setup.arrange()
        self._measured.begin(self._loop.clock.now_s())
        self._setup.start()
        if not self._loop.wait_for(lambda: self._measured.came, _FIRST_SAMPLE_S):
            raise self._master.failed(
                f"was started, but no complete sample arrived within {_FIRST_SAMPLE_S:g} s",
                "the bus may be overloaded: measure fewer symbols, or give every = 2",
            )
        self._master.events.clear()
        self._measured.begin(self._loop.clock.now_s())
        self._measuring, self._said, self._asked_s = True, "", None

    def beat(self) -> None:
        """Ask how it is; the answer is looked at when it comes."""
        if self._measuring and not self._master.awaits:
            self._asked_s = self._loop.clock.now_s() if self._asked_s is None else self._asked_s
            self._master.send(Command.GET_STATUS)

    def troubles(self) -> list[str]:
        """Silence, a list that does not run, lost samples, time stamps that stand still."""
        found = [self._said] if self._said else []
        now_s = self._loop.clock.now_s()
        if self._asked_s is not None and now_s - self._asked_s > _UNANSWERED_S:
            found.append(f"the slave has not answered for {now_s - self._asked_s:.1f} s")
        if Happened.SESSION_TERMINATED in self._master.events:
            found.append("the slave has ended the session")
        if self._decoder.stands_still:
            found.append("the time stamps of its samples stand still")
        if self._measuring and self._measured.lost > _MOST_LOST:
            times = self._master.events.get(Happened.DAQ_OVERLOAD, 0)
            overload = f"; the slave says {times} times that it is overloaded" if times else ""
            found.append(f"{self._measured.lost:.0%} of its samples are lost{overload}")
        return found

    def make_safe(self) -> None:
        """It moves nothing."""

    def is_safe(self) -> bool:
        """It gives no torque."""
        return True

    def close(self) -> None:
        """Let the slave measure nothing any more."""
        if self._in_session:
            self._in_session = self._measuring = False
            self._master.send(Command.DISCONNECT)

    def identify(self) -> dict[str, str]:
        """What the slave calls itself, and the software that its memory names."""
        found = {}
        try:
            self._connect()
            found["software"] = self._setup.software()
            found["station"] = self._master.own_name()
        except DeviceError:  # who does not say so may measure all the same; silence is reported by `come_up`
            pass
        return {name: text for name, text in found.items() if text}

    def examine(self, *, ask: bool) -> Examined:
        """Whether it answers, and is of the software that the symbols are of."""
        where = f"device '{self.name}'"
        if not ask:
            silent = [] if self._measured.came else [Finding("hint", "only answers requests", where)]
            return Examined(answers=self._measured.came, findings=silent)
        try:
            self._connect()
            status, software = self._setup.status(), self._setup.software()
        except BenchError as error:
            return Examined(findings=[Finding.of(error)])
        found = Examined(answers=True, facts={"XCP": "answers"})
        if software:
            found.facts["software"] = software
        if self._file.software and software != self._file.software:
            what = f"its software is '{software}', the symbols are of '{self._file.software}'"
            found.findings.append(
                Finding("fault", what, where, "give the file that belongs to this software")
            )
        self._in_session = False
        if status & DAQ_RUNNING:
            what = "it measures for another master; a run would end that"
            fix = "end the other tool's measurement before a run"
            found.findings.append(Finding("hint", what, where, fix))
        else:
            self._master.ask(Command.DISCONNECT)
        return found

    def _connect(self) -> None:
        self._setup.connect()
        self._in_session = True

    def _take(self, bus: str, block: FrameBlock) -> None:
        if bus != self._wire.name:
            return
        block = standard(block)
        block = block[(block["id"] == self._answer_id) & (block["flags"] & SENT_BY_HOST == 0)]
        block = block[block["length"] > 0]
        measured = (block["data"] & np.uint64(0xFF)) <= LARGEST_ODT_NUMBER
        for frame in block[~measured]:
            self._take_packet(int(frame["data"]).to_bytes(8, "little")[: int(frame["length"])])
        if np.any(measured):
            times, values, counts = self._decoder.take(block[measured])
            self._measured.take(Samples(self._stream, times, values, counts), self._loop.clock.now_s())

    def _take_packet(self, packet: bytes) -> None:
        if self._asked_s is None or self._master.awaits or packet[0] < ERROR or len(packet) < 2:
            self._master.take(packet)
            return
        self._asked_s = None
        if packet[0] == ERROR:
            self._said = f"asked for its status the slave {in_words(packet[1])}"
        elif not packet[1] & DAQ_RUNNING:
            self._said = "it no longer measures: it has restarted, or another master has stopped it"
