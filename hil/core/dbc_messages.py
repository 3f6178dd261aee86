"""Every message of DBC files that a recording has a place for, decoded in whole columns.

For logs of any bus: `hil.core.dbc` reads the few messages that a bench needs, and refuses contradictions.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from hil.core.dbc import database_of, signal_mistakes
from hil.core.errors import BadInputError
from hil.core.frames import ERROR_FRAME, EXTENDED, FrameBlock
from hil.core.signals import FrameLayout, Signal, layout_of

if TYPE_CHECKING:
    from cantools.database.can import Message

Array = npt.NDArray[np.float64]
_LONGEST_BYTES = 8
_EXTENDED_BIT = 1 << 31


@dataclass(frozen=True)
class Selector:
    """A signal is in a frame only if this one has one of these raw values there (multiplexing)."""

    signal: Signal
    values: tuple[int, ...]
    above: Selector | None = None


@dataclass(frozen=True)
class MessageLayout:
    """A message's signals, and which of them are not in every frame of it."""

    layout: FrameLayout
    extended: bool
    selectors: dict[str, Selector]

    @property
    def key(self) -> int:
        """Its identifier, one of 29 bits apart from one of 11."""
        return self.layout.id | (_EXTENDED_BIT if self.extended else 0)


@dataclass(frozen=True)
class MessageSamples:
    """Frames of a message: times (s), shape (n,), and values of each signal, NaN where the frame has none."""

    layout: MessageLayout
    time_s: Array
    values: dict[str, Array]


def read_messages_of(path: Path) -> tuple[list[MessageLayout], list[str]]:
    """The messages of a DBC, and what of it cannot be decoded, a sentence each.

    Raises:
        BadInputError: not a DBC, or no message in it can be decoded.
    """
    found: list[MessageLayout] = []
    remarks: list[str] = []
    for message in database_of(path).messages:
        if not 0 < message.length <= _LONGEST_BYTES:
            remarks.append(f"message '{message.name}' has {message.length} bytes: its frames are left out")
            continue
        broken = {s.name: next(signal_mistakes(s, message), "") for s in message.signals}
        remarks += [
            f"message '{message.name}', signal '{name}' {mistake}: left out"
            for name, mistake in broken.items()
            if mistake
        ]
        layout = layout_of(message)
        signals = {name: signal for name, signal in layout.signals.items() if not broken[name]}
        if signals:
            whole = FrameLayout(layout.name, layout.id, layout.length, signals)
            found.append(MessageLayout(whole, message.is_extended_frame, _selectors(message, layout)))
    if not found:
        raise BadInputError("has no message with a signal", where=str(path), fix="give a DBC with signals")
    return found, remarks


def _selectors(message: Message, layout: FrameLayout) -> dict[str, Selector]:
    described = {signal.name: signal for signal in message.signals}

    def of(name: str, depth: int = 0) -> Selector | None:
        signal = described[name]
        if not signal.multiplexer_ids or not signal.multiplexer_signal or depth > len(described):
            return None
        above = signal.multiplexer_signal
        return Selector(layout.signals[above], tuple(signal.multiplexer_ids), of(above, depth + 1))

    found = {name: of(name) for name in described}
    return {name: selector for name, selector in found.items() if selector is not None}


def decoded(block: FrameBlock, layouts: Sequence[MessageLayout]) -> Iterator[MessageSamples]:
    """Samples of each message that the block has frames of, in the order of `layouts`.

    Frames that are shorter than a message's last signal says are left out: half a frame says nothing.
    """
    flags = np.ascontiguousarray(block["flags"])
    keys = block["id"] | np.where(flags & EXTENDED != 0, np.uint32(_EXTENDED_BIT), np.uint32(0))
    keys[flags & ERROR_FRAME != 0] = np.uint32(0xFFFFFFFF)  # no frame's
    order = np.argsort(keys, kind="stable")
    keys = keys[order]
    times, data = np.ascontiguousarray(block["time_s"]), np.ascontiguousarray(block["data"])
    lengths = np.ascontiguousarray(block["length"])
    for message in layouts:
        first, last = np.searchsorted(keys, message.key), np.searchsorted(keys, message.key, side="right")
        its = order[first:last]
        its = its[lengths[its] >= _bytes_of(message.layout)]
        if len(its):
            yield MessageSamples(message, times[its], _values(message, data[its]))


def _values(message: MessageLayout, payloads: npt.NDArray[np.uint64]) -> dict[str, Array]:
    values = message.layout.decode(payloads)
    for name, selector in message.selectors.items():
        if name in values:
            values[name][~_selected(selector, payloads)] = np.nan
    return values


def _selected(selector: Selector, payloads: npt.NDArray[np.uint64]) -> npt.NDArray[np.bool_]:
    signal = selector.signal
    words = payloads.byteswap() if signal.big_endian else payloads
    raw = words >> np.uint64(signal.shift) & np.uint64((1 << signal.length) - 1)
    chosen = np.isin(raw, np.array(selector.values, np.uint64))
    return chosen & _selected(selector.above, payloads) if selector.above else chosen


def _bytes_of(layout: FrameLayout) -> int:
    """How many bytes a frame must have for every signal to be in it."""
    return max(
        8 - signal.shift // 8 if signal.big_endian else -(-(signal.shift + signal.length) // 8)
        for signal in layout.signals.values()
    )
