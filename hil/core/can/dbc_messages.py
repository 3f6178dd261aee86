"""Every message of DBC files that a recording has a place for, decoded in whole columns, SAE J1939 included.

Every message of DBC files that a recording has a place for, decoded in whole columns, SAE J1939 included.

Identifiers of SAE J1939-21: which frames are of a message that a DBC describes for any source address.

An identifier of 29 bits is priority (3), data page (2), PDU format (8), PDU specific (8), source address (8).
Format, page and, from format 240 on, the specific part are the parameter group number; below 240 that part is
a destination. A DBC of J1939 writes the null address 254 where every source is meant: no device has it.

For logs of any bus: `hil.core.can.dbc` reads the few messages that a bench needs, and refuses contradictions.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from hil.core.can.dbc import LONGEST_BYTES, described, signal_mistakes
from hil.core.can.dbc_text import Ranges
from hil.core.can.frames import ERROR_FRAME, EXTENDED, FrameBlock
from hil.core.can.signals import Signal, signal_of
from hil.core.errors import BadInputError

if TYPE_CHECKING:
    from cantools.database.can import Message
    from cantools.database.can.signal import Signal as DbcSignal

NULL_ADDRESS = 0xFE
_SOURCE = 0xFF
_FIRST_BROADCAST_FORMAT = 240
_EXTENDED_BIT, _LARGEST = 1 << 31, 0x1FFF_FFFF


def group_of(identifier: int) -> int:
    """Parameter group number of an identifier of 29 bits."""
    whole = identifier >> 8 & 0x3FFFF
    return whole if identifier >> 16 & 0xFF >= _FIRST_BROADCAST_FORMAT else whole & ~0xFF


def for_addresses(
    layouts: Sequence[MessageLayout], keys: Iterable[int]
) -> tuple[list[MessageLayout], list[str]]:
    """Layouts with each message of any source address once for each that sends it, and what was found.

    Args:
        keys: of all frames, as `keys_of` gives them. A frame of which the DBC has the whole identifier is
            that message's alone.
    """
    there = set(keys)
    whole = {layout.key for layout in layouts if layout.key in there and not layout.any_address}
    by_group: dict[int, list[int]] = {}
    for key in sorted(there - whole):
        if _EXTENDED_BIT <= key <= _EXTENDED_BIT | _LARGEST:
            by_group.setdefault(group_of(key & ~_EXTENDED_BIT), []).append(key & ~_EXTENDED_BIT)
    found: list[MessageLayout] = []
    remarks: list[str] = []
    for layout in layouts:
        senders = by_group.pop(group_of(layout.id), []) if layout.any_address else []
        if not senders:
            found.append(layout)
            continue
        for identifier in senders:
            name = f"{layout.name}_{_address(identifier)}" if len(senders) > 1 else layout.name
            found.append(replace(layout, name=name, id=identifier))
        listed = ", ".join(f"0x{identifier & _SOURCE:02X}" for identifier in senders)
        remarks.append(f"message '{layout.name}' is of any source address in the DBC: sent by {listed}")
    return found, remarks


def of_other_addresses(layouts: Sequence[MessageLayout], unknown: Mapping[str, int]) -> list[str]:
    """Why frames of no message are not of one that the DBC has for another source address, a sentence each.

    Args:
        unknown: frames by identifier, 29 bits as "0x1234567x".
    """
    groups = {group_of(one.id): one for one in layouts if one.extended and one.is_j1939}
    remarks = []
    for text, count in unknown.items():
        if text.endswith("x") and (layout := groups.get(group_of(int(text[:-1], 16)))) is not None:
            address = f"0x{layout.id & _SOURCE:02X}"
            remarks.append(
                f"{count} frames {text} have the group of message '{layout.name}', which the DBC has for "
                f"address {address} alone: they are of no message (0xFE means any address)"
            )
    return remarks


def _address(identifier: int) -> str:
    return f"{identifier & _SOURCE:02X}"


Array = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]
EXTENDED_BIT = 1 << 31
_NOT_A_KEY = 0xFFFFFFFF


@dataclass(frozen=True)
class Selector:
    """A signal is in a frame only if this one's raw value there lies in one of these ranges."""

    signal: Signal
    ranges: Ranges
    above: Selector | None = None

    def selects(self, payloads: npt.NDArray[np.uint64]) -> Bools:
        """Which frames have the signal."""
        signal = self.signal
        words = payloads.byteswap() if signal.big_endian else payloads
        raw = words >> np.uint64(signal.shift) & np.uint64((1 << signal.length) - 1)
        chosen = np.zeros(len(raw), bool)
        for low, high in self.ranges:
            chosen |= (raw >= np.uint64(low)) & (raw <= np.uint64(high))
        return chosen & self.above.selects(payloads) if self.above else chosen


@dataclass(frozen=True)
class Branch:
    """Where a signal lies: in every frame of its message, or in those that a selector names."""

    signal: Signal
    selector: Selector | None = None

    @property
    def needed_bytes(self) -> int:
        """How many bytes a frame must have for all of the signal to be in it."""
        signal = self.signal
        return 8 - signal.shift // 8 if signal.big_endian else -(-(signal.shift + signal.length) // 8)


@dataclass(frozen=True)
class MessageLayout:
    """A message's signals: each in one place, or by its selector in several.

    `is_j1939`: the DBC says that its identifier is one of J1939 (`VFrameFormat` J1939PG).
    """

    name: str
    id: int
    extended: bool
    signals: Mapping[str, tuple[Branch, ...]]
    is_j1939: bool = False

    @property
    def any_address(self) -> bool:
        """Whether every source address is meant."""
        return self.is_j1939 and self.extended and self.id & 0xFF == NULL_ADDRESS

    @property
    def key(self) -> int:
        """Its identifier, one of 29 bits apart from one of 11."""
        return self.id | (EXTENDED_BIT if self.extended else 0)

    def unit(self, signal: str) -> str:
        """The unit of a signal."""
        return self.signals[signal][0].signal.unit


@dataclass(frozen=True)
class MessageSamples:
    """Frames of a message: times (s), shape (n,), and values of each signal, NaN where the frame has none.

    `short`: how many of them end before a signal that should be in them.
    """

    layout: MessageLayout
    time_s: Array
    values: dict[str, Array]
    short: int


def read_messages_of(path: Path) -> tuple[list[MessageLayout], list[str]]:
    """The messages of a DBC, and what of it cannot be decoded, a sentence each.

    Raises:
        BadInputError: not a DBC, or no message in it can be decoded.
    """
    found: list[MessageLayout] = []
    file = described(path)
    remarks = list(file.remarks)
    for message in file.database.messages:
        if not 0 < message.length <= LONGEST_BYTES:
            remarks.append(f"message '{message.name}' has {message.length} bytes: its frames are left out")
            continue
        signals: dict[str, list[Branch]] = {}
        for signal in message.signals:
            mistake = next(signal_mistakes(signal, message), "")
            if mistake:
                remarks.append(f"message '{message.name}', signal '{signal.name}' {mistake}: left out")
            else:
                branch = Branch(signal_of(signal), _selector(signal, message, file.ranges))
                signals.setdefault(signal.name, []).append(branch)
        if signals:
            whole = {name: tuple(branches) for name, branches in signals.items()}
            is_j1939 = message.protocol == "j1939"
            extended = message.is_extended_frame
            found.append(MessageLayout(message.name, message.frame_id, extended, whole, is_j1939))
    if not found:
        raise BadInputError("has no message with a signal", where=str(path), fix="give a DBC with signals")
    return found, remarks


def _selector(
    signal: DbcSignal, message: Message, ranges: Mapping[tuple[int, str], Ranges], depth: int = 0
) -> Selector | None:
    """By what a signal is selected; None if it is in every frame."""
    above = next((s for s in message.signals if s.name == signal.multiplexer_signal), None)
    if not signal.multiplexer_ids or above is None or depth > len(message.signals):
        return None
    own = tuple((value, value) for value in signal.multiplexer_ids)
    extended = EXTENDED_BIT if message.is_extended_frame else 0
    chosen = ranges.get((message.frame_id | extended, signal.name), own)
    return Selector(signal_of(above), chosen, _selector(above, message, ranges, depth + 1))


def keys_of(block: FrameBlock) -> npt.NDArray[np.uint32]:
    """By frame the key of a message that it could be of; error frames have no message's key."""
    flags = np.ascontiguousarray(block["flags"])
    keys = block["id"] | np.where(flags & EXTENDED != 0, np.uint32(EXTENDED_BIT), np.uint32(0))
    keys[flags & ERROR_FRAME != 0] = np.uint32(_NOT_A_KEY)
    return np.asarray(keys, np.uint32)


def decoded(block: FrameBlock, layouts: Sequence[MessageLayout]) -> Iterator[MessageSamples]:
    """Samples of each message that the block has frames of, in the order of `layouts`.

    A frame that is shorter than its message gives the signals that it holds.
    """
    keys = keys_of(block)
    order = np.argsort(keys, kind="stable")
    keys = keys[order]
    times, data = np.ascontiguousarray(block["time_s"]), np.ascontiguousarray(block["data"])
    lengths = np.ascontiguousarray(block["length"])
    for message in layouts:
        first, last = np.searchsorted(keys, message.key), np.searchsorted(keys, message.key, side="right")
        its = order[first:last]
        if len(its):
            values, short = _values(message, data[its], lengths[its])
            yield MessageSamples(message, times[its], values, short)


def _values(
    message: MessageLayout, payloads: npt.NDArray[np.uint64], lengths: npt.NDArray[np.uint8]
) -> tuple[dict[str, Array], int]:
    """Values by signal, and how many frames end before a signal that should be in them."""
    found = {}
    cut = np.zeros(len(payloads), bool)
    shortest = int(lengths.min())
    for name, branches in message.signals.items():
        values: Array | None = None
        for branch in branches:
            read = branch.signal.decode(payloads)
            there = branch.selector.selects(payloads) if branch.selector else None
            if shortest < branch.needed_bytes:
                held = lengths >= branch.needed_bytes
                cut |= ~held if there is None else there & ~held
                there = held if there is None else there & held
            if there is not None:
                read[~there] = np.nan
            values = read if values is None else np.where(np.isnan(read), values, read)
        assert values is not None
        found[name] = values
    return found, int(np.count_nonzero(cut))
