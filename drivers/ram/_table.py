"""The table of a monitor of the RMCU's memory."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from pydantic import Field

from drivers.ram._decoder import bits_of, packed
from drivers.ram._monitor import RamMonitor
from drivers.table import Connections, DeviceTable, File
from hil.core.can.symbol_files import read_symbols
from hil.core.can.symbols import Symbol, Symbols, refuse_extended
from hil.core.can.xcp import MOST_BYTES
from hil.core.channels import unit_of
from hil.core.errors import BadInputError
from hil.core.units import has_unit

_STAMP_BYTES = 2  # of most slaves on CAN


class RamTable(DeviceTable):
    """Measurement of the RMCU's memory by XCP on CAN, with its symbol file."""

    kind: str = "ram-xcp"
    bus: str
    symbols: File = Field(description="an A2L, or a CSV with symbol, address, type, unit, scale, offset")
    channels: dict[str, str] = Field(min_length=1, description="symbol by channel (name with unit)")
    request_id: int | None = Field(None, ge=0, le=0x7FF, description="of commands; default: the A2L's")
    answer_id: int | None = Field(None, ge=0, le=0x7FF, description="of answers and data; default: the A2L's")
    event: int = Field(0, ge=0, le=0xFFFE, description="event channel of the RMCU for the measurement")
    event_period_s: float = Field(0.001, ge=1e-4, le=10, description="period of the event, s")
    every: int = Field(1, ge=1, le=255, description="every n-th sample of the event is sent")
    answers_within_s: float = Field(0.2, ge=0.01, le=10, description="deadline of an answer")

    def read(self) -> tuple[Symbols, dict[str, Symbol], tuple[int, int]]:
        """The file, the symbol of each channel, and the identifiers of commands and answers.

        Raises:
            BadInputError: the file cannot be used or lacks a symbol, or no one gives identifiers.
        """
        file = read_symbols(self.symbols)
        found = {
            channel: file.find(symbol).in_unit(unit_of(channel), str(self.symbols))
            for channel, symbol in self.channels.items()
        }
        ids = []
        for key, theirs in (("request_id", file.request_id), ("answer_id", file.answer_id)):
            ours = getattr(self, key)
            number = theirs if ours is None else ours
            if number is None:
                raise BadInputError(
                    f"has no {key} of XCP on CAN",
                    where=str(self.symbols),
                    fix=f"give {key} in the bench file",
                )
            ids.append(refuse_extended(number, key, str(self.symbols)))
        if ids[0] == ids[1]:
            raise BadInputError(
                f"request_id and answer_id are both 0x{ids[0]:03X}",
                where=str(self.symbols),
                fix="a slave answers under another identifier",
            )
        return file, found, (ids[0], ids[1])

    def open(self, name: str, connections: Connections) -> RamMonitor:
        """Make the driver.

        Raises:
            BadInputError: the file of symbols cannot be used.
        """
        file, symbols, ids = self.read()
        return RamMonitor(
            name,
            connections.loop,
            connections.wires[self.bus],
            ids,
            symbols,
            file,
            self.event,
            self.every,
            self.event_period_s,
            self.answers_within_s,
        )

    def unusable_files(self) -> Iterator[tuple[str, BadInputError]]:
        """The file of symbols, if it cannot be used."""
        try:
            self.read()
        except BadInputError as error:
            yield "symbols", error

    def remarks(self) -> Iterator[str]:
        """Units of the file of symbols."""
        file = read_symbols(self.symbols)
        for channel, name in self.channels.items():
            symbol, wanted = file.find(name), unit_of(channel)
            if wanted and not has_unit(symbol.unit):
                yield f"{self.symbols}: symbol '{name}' says no unit and is taken in {wanted}"
            elif wanted and symbol.in_unit(wanted, str(self.symbols)) is not symbol:
                yield f"{self.symbols}: symbol '{name}' was converted from {symbol.unit} to {wanted}"

    def identifiers(self) -> Mapping[int, str]:
        """Those of XCP."""
        request, answer = self.read()[2]
        return {request: "an XCP command", answer: "an XCP answer"}

    def described_in(self) -> dict[str, tuple[str, str]]:
        """Symbols of the file."""
        return {channel: ("symbols", f"symbol '{symbol}'") for channel, symbol in self.channels.items()}

    def asked_by_hosts(self) -> tuple[int, ...]:
        """Commands."""
        return (self.read()[2][0],)

    def sends_by_itself(self) -> bool:
        """It says nothing before it is asked."""
        return False

    def bits_each_second(self) -> float:
        """Of the packets of every sample; a command and its answer among them at any time."""
        odts = packed(list(self.read()[1].values()), _STAMP_BYTES, MOST_BYTES, 1, MOST_BYTES)
        return bits_of(odts, _STAMP_BYTES) / (self.every * self.event_period_s)
