"""A DBC file as frame layouts, refused where its frames cannot be sent or read as they are described."""

from __future__ import annotations

import logging
import math
from collections.abc import Container, Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING

import cantools

from hil.core.can.dbc_text import Ranges, prepared
from hil.core.can.signals import FrameLayout, in_units, layout_of
from hil.core.errors import BadInputError
from hil.core.errors.wording import printable
from hil.core.files import read_device_text

if TYPE_CHECKING:
    from cantools.database.can import Database, Message
    from cantools.database.can.signal import Signal as DbcSignal

LARGEST_IDENTIFIER = 0x7FF
LONGEST_BYTES = 8
_LONGEST_COUNT = 53  # bits that a float64 holds exactly
_FIX = "correct the DBC; benches/rmcu.dbc is an example"

# What the parser finds odd it also logs; what matters of it is refused here.
logging.getLogger("cantools").addHandler(logging.NullHandler())


@dataclass(frozen=True)
class Needed:
    """What a user of a DBC needs of one message.

    `whole` are counters and enumerations, which have no scaling; `texts` are values that a signal's value
    table must name; `checksum` is the signal of the frame's CRC, which covers the first seven bytes;
    `optional` signals are used if the message has them; `may_miss`: the file need not have the message.
    `units`: in which values of a signal are wanted; they are converted from what the file says.
    """

    signals: tuple[str, ...]
    whole: tuple[str, ...] = ()
    texts: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    checksum: str = ""
    optional: tuple[str, ...] = ()
    may_miss: bool = False
    units: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Names:
    """What a DBC calls messages, signals and values, by our name for them; what is left out has our name.

    `messages`: name of each message; `signals`: by message, the name of each signal; `values`: by message
    and signal, each text of its value table. Messages and signals on the left are always ours.
    """

    messages: Mapping[str, str] = field(default_factory=dict)
    signals: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    values: Mapping[str, Mapping[str, Mapping[str, str]]] = field(default_factory=dict)

    def message(self, ours: str) -> str:
        """The DBC's name of our message."""
        return self.messages.get(ours, ours)

    def signal(self, message: str, ours: str) -> str:
        """The DBC's name of a signal of our message."""
        return self.signals.get(message, {}).get(ours, ours)

    def text(self, message: str, signal: str, ours: str) -> str:
        """What the DBC calls a value of our signal."""
        return self.values.get(message, {}).get(signal, {}).get(ours, ours)

    def ours(self, message: str) -> dict[str, str]:
        """Our name of each signal that has another in the DBC."""
        return {theirs: ours for ours, theirs in self.signals.get(message, {}).items()}

    def our_texts(self, message: str, signal: str) -> dict[str, str]:
        """Our text of each value that has another in the DBC."""
        return {theirs: ours for ours, theirs in self.values.get(message, {}).get(signal, {}).items()}


@dataclass(frozen=True)
class Dbc:
    """Layouts by message; value tables (text to number) by message and signal; all by our names.

    `remarks`: units that were converted, or that the file does not say, a sentence each.
    """

    layouts: dict[str, FrameLayout]
    texts: dict[tuple[str, str], dict[str, int]]
    remarks: tuple[str, ...] = ()


def read_dbc(path: Path, needed: Mapping[str, Needed], names: Names | None = None) -> Dbc:
    """Layouts and value tables of the messages that are needed; others in the file are not looked at.

    Args:
        needed: by our names.
        names: what the file calls them; ours if left out.

    Raises:
        BadInputError: not a DBC, or a needed message or signal is missing or cannot be used: file, message,
            signal, as the file calls them.
    """
    names = names or Names()
    file = described(path)
    database = file.database
    found: dict[str, Message] = {}
    for remark in file.remarks:
        if any(f"'{names.message(ours)}'" in remark for ours in needed):
            raise BadInputError(remark.removesuffix(": left out"), where=str(path), fix=_FIX)
    there = {message.name: message for message in database.messages}
    _refuse_missing(there, needed, names, str(path))
    for ours, parts in needed.items():
        name = names.message(ours)
        if name not in there:
            continue
        message = there[name]
        for mistake in _mistakes(message, _as_called(parts, names, ours)):
            raise BadInputError(f"message '{name}'{mistake}", where=str(path), fix=_FIX)
        found[ours] = message
    for a, b in combinations(found.values(), 2):
        if a.frame_id == b.frame_id:
            raise BadInputError(
                f"messages '{a.name}' and '{b.name}' have the same identifier 0x{a.frame_id:X}",
                where=str(path),
                fix=_FIX,
            )
    layouts = {ours: _renamed(layout_of(message), names.ours(ours)) for ours, message in found.items()}
    remarks: list[str] = []
    for ours, layout in layouts.items():
        called = f"message '{found[ours].name}', "
        layouts[ours] = in_units(layout, needed[ours].units, str(path), remarks, called)
    return Dbc(layouts, dict(_texts(found, names)), tuple(remarks))


def _refuse_missing(there: Container[str], needed: Mapping[str, Needed], names: Names, where: str) -> None:
    """Raises:
    BadInputError: names all messages that are missing at once.
    """
    ours = (ours for ours, one in needed.items() if not one.may_miss or ours in names.messages)
    missing = [name for name in map(names.message, ours) if name not in there]
    if missing:
        called = ", ".join(f"'{name}'" for name in missing)
        raise BadInputError(
            f"has no message{'s' if len(missing) > 1 else ''} {called}",
            where=where,
            fix="use the RMCU's DBC; if it calls them otherwise, [rmcu.messages] of the bench file says how",
        )


def _as_called(needed: Needed, names: Names, message: str) -> Needed:
    """What is needed of a message, as the file calls it."""

    def called(signals: tuple[str, ...]) -> tuple[str, ...]:
        return tuple(names.signal(message, signal) for signal in signals)

    texts = {
        names.signal(message, signal): tuple(names.text(message, signal, text) for text in wanted)
        for signal, wanted in needed.texts.items()
    }
    checksum = names.signal(message, needed.checksum) if needed.checksum else ""
    optional = called(needed.optional)
    whole = called(needed.whole)
    return Needed(called(needed.signals), whole, texts, checksum, optional, needed.may_miss, needed.units)


def _renamed(layout: FrameLayout, ours: Mapping[str, str]) -> FrameLayout:
    signals = {ours.get(name, name): signal for name, signal in layout.signals.items()}
    return replace(layout, signals=signals)


def _texts(found: Mapping[str, Message], names: Names) -> Iterator[tuple[tuple[str, str], dict[str, int]]]:
    """Value tables by our names."""
    for message, described in found.items():
        signals = names.ours(message)
        for signal in described.signals:
            if signal.choices:
                name = signals.get(signal.name, signal.name)
                texts = names.our_texts(message, name)
                yield (
                    (message, name),
                    {texts.get(str(text), str(text)): int(n) for n, text in signal.choices.items()},
                )


@dataclass(frozen=True)
class Described:
    """A DBC as cantools has it, what was left out, and ranges of selector values by message and signal."""

    database: Database
    ranges: Mapping[tuple[int, str], Ranges]
    remarks: tuple[str, ...]


def database_of(path: Path) -> Database:
    """A DBC as cantools has it.

    Raises:
        BadInputError: it cannot be read, is no DBC, or has no messages.
    """
    return described(path).database


def described(path: Path) -> Described:
    """A DBC with all that is known of its messages.

    Raises:
        BadInputError: it cannot be read, is no DBC, or has no messages.
    """
    text = prepared(read_device_text(path, "check [rmcu] dbc"))
    try:
        # Not strict: what is wrong with messages that no one needs is no reason to refuse the file.
        database = cantools.database.load_string(text.text, "dbc", strict=False)
    except Exception as error:  # the parser raises whatever it stumbles over
        words = " ".join(str(error).removeprefix("DBC: ").strip('"').split())
        raise BadInputError(
            f"not a DBC file: {printable(words, 200)}", where=str(path), fix="give the RMCU's DBC"
        ) from error
    if not database.messages:  # type: ignore[union-attr]
        raise BadInputError("is a DBC without messages", where=str(path), fix="give the RMCU's DBC")
    return Described(database, text.ranges, text.remarks)  # type: ignore[arg-type]


def _mistakes(message: Message, needed: Needed) -> Iterator[str]:
    """What makes the message unusable; each text goes on after the message's name."""
    if message.is_extended_frame or message.frame_id > LARGEST_IDENTIFIER:
        yield f": identifier 0x{message.frame_id:X} is extended (29 bits); the bench's frames have 11 bits"
    if not 0 < message.length <= LONGEST_BYTES:
        yield f" has {message.length} bytes; a classic CAN frame has 1 to {LONGEST_BYTES}"
    present = {signal.name: signal for signal in message.signals}
    used = []
    for name in needed.signals:
        if name not in present:
            yield f" has no signal '{name}'"
            return
        used.append(present[name])
    used += [present[name] for name in needed.optional if name in present]
    for signal in used:
        further = _further_mistakes(signal, whole=signal.name in needed.whole)
        for mistake in (*signal_mistakes(signal, message), *further):
            yield f", signal '{signal.name}' {mistake}"
    for a, b in combinations(used, 2):
        if set(_bits(a)) & set(_bits(b)):
            yield f": signals '{a.name}' and '{b.name}' overlap"
    for name, texts in needed.texts.items():
        named = {str(text) for text in (present[name].choices or {}).values()}
        for text in texts:
            if text not in named:
                yield f", signal '{name}' has no value named '{text}' (VAL_)"
    if needed.checksum and sorted(_bits(present[needed.checksum])) != list(range(56, 64)):
        yield f", signal '{needed.checksum}' is not byte 7, the last: the CRC covers bytes 0 to 6"


def _further_mistakes(signal: DbcSignal, *, whole: bool) -> Iterator[str]:
    """What makes a signal unusable for a bench."""
    if signal.multiplexer_ids:
        yield "is multiplexed; the bench's frames always hold the same signals"
    if whole and (
        signal.is_float or signal.is_signed or (float(signal.scale), float(signal.offset)) != (1.0, 0.0)
    ):
        yield "counts, and must be unsigned with (1,0)"


def signal_mistakes(signal: DbcSignal, message: Message) -> Iterator[str]:
    """What makes a signal's bits impossible to read; each text goes on after the signal's name."""
    scale, offset = float(signal.scale), float(signal.offset)
    if signal.length < 1:
        yield f"has {signal.length} bits"
    if scale == 0 or not math.isfinite(scale) or not math.isfinite(offset):
        yield f"has the factor {scale:g} and the offset {offset:g}: its bits give no value"
    if signal.is_float and signal.length not in (32, 64):
        yield f"is a float of {signal.length} bits; IEEE 754 has 32 or 64"
    if not signal.is_float and signal.length > _LONGEST_COUNT:
        yield f"is an integer of {signal.length} bits; at most {_LONGEST_COUNT} are counted exactly"
    if any(not 0 <= bit < 8 * message.length for bit in _bits(signal)):
        yield f"reaches beyond the message's {message.length} bytes"


def _bits(signal: DbcSignal) -> list[int]:
    """Positions of the signal's bits in the frame: 8·byte + bit, bit 0 the lowest of its byte."""
    if signal.byte_order == "little_endian":
        return list(range(signal.start, signal.start + signal.length))
    first = 8 * (signal.start // 8) + 7 - signal.start % 8  # counted from the frame's first bit on the wire
    return [8 * (n // 8) + 7 - n % 8 for n in range(first, first + signal.length)]
