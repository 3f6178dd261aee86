"""Where a signal lies in a CAN frame, and its physical value, for whole blocks of frames at once.

Layouts come from a DBC (cantools) or from the PDO mapping of an EDS (canopen); both ends of the wire use
this class, and tests hold it against cantools frame by frame.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from hil.core.errors import BadInputError
from hil.core.errors.wording import printable
from hil.core.runtime.compiled import compiled
from hil.core.units import UnitError, conversion, has_unit

if TYPE_CHECKING:
    from cantools.database.can import Message
    from cantools.database.can.signal import Signal as DbcSignal

Payloads = npt.NDArray[np.uint64]


@dataclass(frozen=True)
class Signal:
    """`length` bits from bit `shift` of the payload, read as a little-endian 64-bit number.

    Big-endian signals lie at `shift` of the byte-reversed payload. Physical value = raw·scale + offset.
    """

    name: str
    shift: int
    length: int
    signed: bool = False
    scale: float = 1.0
    offset: float = 0.0
    unit: str = ""
    is_float: bool = False
    big_endian: bool = False

    @property
    def limits(self) -> tuple[float, float]:
        """Smallest and largest physical value that fits."""
        if self.is_float:
            return (-np.inf, np.inf)
        ends = [count * self.scale + self.offset for count in self.counts]
        return (min(ends), max(ends))

    @property
    def place(self) -> tuple[int, int, bool, bool, bool]:
        """Where and how its number lies, for compiled code."""
        return (self.shift, self.length, self.signed, self.big_endian, self.is_float)

    def in_unit(self, wanted: str) -> Signal:
        """The same signal with values in another unit; one that says no unit is taken to be in it.

        Raises:
            UnitError: its unit is not known, or is of another quantity.
        """
        if not has_unit(self.unit):
            return self
        found = conversion(self.unit, wanted)
        if found.is_none:
            return self
        scale, offset = found.of_line(self.scale, self.offset)
        return replace(self, scale=scale, offset=offset, unit=wanted)

    def raw(self, payload: int) -> int:
        """Unsigned raw value in one payload."""
        word = int.from_bytes(payload.to_bytes(8, "little"), "big") if self.big_endian else payload
        return (word >> self.shift) & ((1 << self.length) - 1)

    def value(self, payload: int) -> float:
        """Physical value in one payload."""
        raw = self.raw(payload)
        if self.is_float:
            kind = "<f" if self.length == 32 else "<d"
            number: float = struct.unpack(kind, raw.to_bytes(self.length // 8, "little"))[0]
            return number * self.scale + self.offset
        if self.signed and raw >> (self.length - 1):
            raw -= 1 << self.length
        return raw * self.scale + self.offset

    def decode(self, payloads: Payloads) -> npt.NDArray[np.float64]:
        """Physical values of many payloads, shape as given."""
        words = payloads.byteswap() if self.big_endian else payloads
        raw = (words >> np.uint64(self.shift)) & np.uint64((1 << self.length) - 1)
        if self.is_float:
            bits = raw.astype(np.uint32) if self.length == 32 else raw
            numbers = bits.view(np.float32 if self.length == 32 else np.float64).astype(np.float64)
            return np.asarray(numbers * self.scale + self.offset)
        counts = raw.astype(np.float64)
        if self.signed:
            up = np.uint64(64 - self.length)
            counts = ((raw << up).view(np.int64) >> np.int64(64 - self.length)).astype(np.float64)
        return np.asarray(counts * self.scale + self.offset)

    def encode(self, values: npt.ArrayLike) -> Payloads:
        """Payloads with only this signal set, rounded to its resolution and clipped to its range."""
        physical = np.atleast_1d(np.asarray(values, dtype=float))
        if self.is_float:
            kind, bits = (np.float32, np.uint32) if self.length == 32 else (np.float64, np.uint64)
            numbers = ((physical - self.offset) / self.scale).astype(kind)
            words = numbers.view(bits).astype(np.uint64) << np.uint64(self.shift)
        else:
            words = np.empty(len(physical), np.uint64)
            low, high = self.counts
            _pack(physical, self.scale, self.offset, low, high, self.shift, self.length, words)
        return words.byteswap() if self.big_endian else words

    @cached_property
    def counts(self) -> tuple[float, float]:
        """Smallest and largest number that fits, unscaled; of a float its bits', which limit nothing."""
        if self.is_float:
            return -np.inf, np.inf
        low = -(1 << (self.length - 1)) if self.signed else 0
        return float(low), float(low + (1 << self.length) - 1)


@compiled
def _pack(values, scale, offset, low, high, shift, length, words):  # type: ignore[no-untyped-def]
    mask = ~np.uint64(0) >> np.uint64(64 - length)
    for i in range(values.shape[0]):
        count = _count_of(values[i], scale, offset, low, high)
        words[i] = (np.uint64(count) & mask) << np.uint64(shift)


@compiled
def _count_of(value, scale, offset, low, high):  # type: ignore[no-untyped-def]
    return np.int64(min(max(np.rint((value - offset) / scale), low), high))


@compiled
def payload_with(value, place, scale, offset, low, high):  # type: ignore[no-untyped-def]
    """A payload with only one signal set, as `Signal.encode` does; `place`, `low`, `high`: of the signal."""
    if place[4]:
        number = (value - offset) / scale
        word = _bits_of_single(number) if place[1] == 32 else _bits_of_double(number)
    else:
        word = np.uint64(_count_of(value, scale, offset, low, high))
    word = (word & (~np.uint64(0) >> np.uint64(64 - place[1]))) << np.uint64(place[0])
    return swapped(word) if place[3] else word


@compiled
def _bits_of_single(number):  # type: ignore[no-untyped-def]
    return np.uint64(np.float32(number).view(np.uint32))


@compiled
def _bits_of_double(number):  # type: ignore[no-untyped-def]
    return np.float64(number).view(np.uint64)


@compiled
def swapped(word):  # type: ignore[no-untyped-def]
    """A 64-bit payload with its bytes in reverse order, for compiled code."""
    turned = np.uint64(0)
    for _ in range(8):
        turned = (turned << np.uint64(8)) | (word & np.uint64(0xFF))
        word >>= np.uint64(8)
    return turned


@compiled
def bits_at(payload, place):  # type: ignore[no-untyped-def]
    """The bits of a signal, unsigned, for compiled code; `place`: see `Signal.place`."""
    word = swapped(payload) if place[3] else payload
    return np.int64((word >> np.uint64(place[0])) & (~np.uint64(0) >> np.uint64(64 - place[1])))


@compiled
def number_at(payload, place):  # type: ignore[no-untyped-def]
    """The number in a signal, unscaled, for compiled code."""
    bits = bits_at(payload, place)
    if place[4]:
        return single_of(bits) if place[1] == 32 else double_of(bits)
    if place[2] and bits >> (place[1] - 1):
        bits -= 1 << place[1]
    return np.float64(bits)


# One `view` a function: numba compiles no more.
@compiled
def single_of(bits):  # type: ignore[no-untyped-def]
    """The IEEE single whose bits are the low 32 of a 64-bit number, for compiled code."""
    return np.float64(np.uint32(bits).view(np.float32))


@compiled
def double_of(bits):  # type: ignore[no-untyped-def]
    """The IEEE double whose bits are a 64-bit number, for compiled code."""
    return np.uint64(bits).view(np.float64)


@dataclass(frozen=True)
class FrameLayout:
    """A frame with its identifier, payload length in bytes and signals."""

    name: str
    id: int
    length: int
    signals: dict[str, Signal]

    def decode(self, payloads: Payloads) -> dict[str, npt.NDArray[np.float64]]:
        """Physical values of every signal."""
        return {name: signal.decode(payloads) for name, signal in self.signals.items()}

    def encode(self, **values: npt.ArrayLike) -> Payloads:
        """Payloads, shape (n,), from physical values (numbers or shape (n,)); other signals are zero."""
        payloads = np.zeros(1, np.uint64)
        for name, value in values.items():
            payloads = payloads | self.signals[name].encode(value)
        return payloads


def in_units(
    layout: FrameLayout, wanted: Mapping[str, str], where: str, remarks: list[str], called: str = ""
) -> FrameLayout:
    """A layout of which some signals have values in units that are wanted.

    Args:
        wanted: units by signal, by the layout's names; of signals that it has not, nothing happens.
        where: the file, for messages.
        remarks: what was converted, and what says no unit, is added here.
        called: what stands before a signal in messages.

    Raises:
        BadInputError: a signal is in a unit that cannot be converted: file, signal, and what to do.
    """
    signals = dict(layout.signals)
    for name, unit in wanted.items():
        if name not in signals:
            continue
        given = signals[name]
        try:
            signals[name] = given.in_unit(unit)
        except UnitError as error:
            what = f"{called}signal '{given.name}' {error.what}"
            raise BadInputError(what, where=where, fix=error.fix) from None
        if not has_unit(given.unit):
            remarks.append(f"{where}: {called}signal '{given.name}' says no unit and is taken in {unit}")
        elif signals[name] is not given:
            remarks.append(
                f"{where}: {called}signal '{given.name}' was converted from {given.unit} to {unit}"
            )
    return replace(layout, signals=signals)


def layout_of(message: Message) -> FrameLayout:
    """Layout of a message from a DBC."""
    signals = {one.name: signal_of(one) for one in message.signals}
    return FrameLayout(message.name, message.frame_id, message.length, signals)


def signal_of(described: DbcSignal) -> Signal:
    """A signal from a DBC."""
    shift = described.start
    big_endian = described.byte_order == "big_endian"
    if big_endian:
        # position counted from the frame's first bit
        msb_first = 8 * (described.start // 8) + (7 - described.start % 8)
        shift = 64 - msb_first - described.length
    return Signal(
        described.name,
        shift,
        described.length,
        described.is_signed,
        float(described.scale),
        float(described.offset),
        printable(described.unit or ""),
        described.is_float,
        big_endian,
    )
