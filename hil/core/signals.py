"""Where a signal lies in a CAN frame, and its physical value, for whole blocks of frames at once.

Layouts come from a DBC (cantools) or from the PDO mapping of an EDS (canopen); both ends of the wire use
this class, and tests hold it against cantools frame by frame.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from hil.core.compiled import compiled
from hil.core.printable import printable

if TYPE_CHECKING:
    from cantools.database.can import Message

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


def layout_of(message: Message) -> FrameLayout:
    """Layout of a message from a DBC."""
    signals = {}
    for s in message.signals:
        shift = s.start
        if s.byte_order == "big_endian":
            msb_first = 8 * (s.start // 8) + (7 - s.start % 8)  # position counted from the frame's first bit
            shift = 64 - msb_first - s.length
        signals[s.name] = Signal(
            s.name,
            shift,
            s.length,
            s.is_signed,
            float(s.scale),
            float(s.offset),
            printable(s.unit or ""),
            s.is_float,
            s.byte_order == "big_endian",
        )
    return FrameLayout(message.name, message.frame_id, message.length, signals)
