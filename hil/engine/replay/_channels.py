"""Several logs as one, and which of their channels is which bus."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hil.core.can.frames import ERROR_FRAME, EXTENDED, FrameBlock
from hil.core.can_logs import CanLog
from hil.core.errors import BadInputError
from hil.core.errors.wording import printable
from hil.engine.replay._clocks import refuse_overlap, remarks_on_clocks, shifted

_PICK = "select it with --bus BUS=CHANNEL"


@dataclass(frozen=True)
class Frames:
    """The frames of one or several logs, their stamps on one clock that begins with the first of them.

    `began_ns`: wall-clock time of its zero, ns since 1970; None if no log says. `remarks`: what lies between.
    """

    channels: Mapping[tuple[str, str], FrameBlock]
    began_ns: int | None
    remarks: Sequence[str] = ()

    def of(self, choice: str) -> FrameBlock | None:
        """Frames of a channel, in every log that has it, or of `FILE:CHANNEL`; None if there is none.

        Raises:
            BadInputError: two logs have frames of the same time.
        """
        blocks = {
            file: block
            for (file, channel), block in self.channels.items()
            if choice in (channel, f"{file}:{channel}")
        }
        if not blocks:
            return None
        ends = [(file, float(b["time_s"][0]), float(b["time_s"][-1])) for file, b in blocks.items() if len(b)]
        refuse_overlap(ends, choice)
        block = np.concatenate(list(blocks.values()))
        return block[np.argsort(block["time_s"], kind="stable")]

    @property
    def names(self) -> list[str]:
        """Of all channels, each once."""
        return list(dict.fromkeys(channel for _, channel in self.channels))


def merged(logs: Sequence[CanLog], shifts_s: Mapping[str, float] | None = None) -> Frames:
    """All logs on one clock.

    Args:
        shifts_s: by file name, what is to be added to a log's clock.

    Raises:
        BadInputError: nothing says how the stamps of several logs lie to each other, they contradict each
            other, or one is given twice.
    """
    logs = shifted(logs, shifts_s or {})
    for place, log in enumerate(logs):
        if any(log.path.samefile(other.path) for other in logs[:place]):
            raise BadInputError("is given twice", where=str(log.path), fix="name each log once")
        if len(logs) > 1 and log.began_ns is None:
            raise BadInputError(
                "its time stamps are not absolute, so it cannot be aligned with the other logs",
                where=str(log.path),
                fix="replay each log separately, or give logs with absolute time stamps",
            )
    remarks = remarks_on_clocks(logs, shifts_s or {})
    first_ns = min(
        (log.began_ns or 0) + round(1e9 * float(block["time_s"][0]))
        for log in logs
        for block in log.channels.values()
    )
    channels: dict[tuple[str, str], FrameBlock] = {}
    for log in logs:
        for channel, block in log.channels.items():
            moved = block.copy()
            moved["time_s"] += ((log.began_ns or 0) - first_ns) * 1e-9
            key = (log.path.name, channel)
            if key in channels:  # files of one name in two folders
                moved = np.concatenate([channels[key], moved])
            channels[key] = moved
    return Frames(channels, first_ns if logs[0].began_ns is not None else None, remarks)


def chosen_buses(
    frames: Frames, known: Mapping[str, set[int]], names: Mapping[str, set[str]], picked: Mapping[str, str]
) -> tuple[dict[str, FrameBlock], list[str], dict[str, str]]:
    """Frames of each bus that the log has, what was taken for what, a sentence each, and each bus's channel.

    Args:
        known: by bus, the identifiers that its devices send or hear.
        names: by bus, what a log may call it.
        picked: by bus, the log's channel that a person named.

    Raises:
        BadInputError: a channel that is not there, or that only a person can pick; what there is.
    """
    for bus, channel in picked.items():
        if bus not in known:
            raise BadInputError(
                f"--bus {printable(bus)}={printable(channel)}: the bench has no bus '{printable(bus)}'",
                fix=f"it has: {', '.join(known)}",
            )
        if frames.of(channel) is None:
            raise BadInputError(
                f"--bus {printable(bus)}={printable(channel)}: no log has a channel '{printable(channel)}'",
                fix=f"there is: {listed(frames, known)}",
            )
    found: dict[str, FrameBlock] = {}
    lines: list[str] = []
    channels: dict[str, str] = {}
    for bus, identifiers in known.items():
        chosen = picked.get(bus) or _guessed(frames, bus, identifiers, names[bus], known)
        block = frames.of(chosen) if chosen else None
        if block is None or chosen is None:
            lines.append(f"no log has frames of bus '{bus}': its channels are missing")
            continue
        found[bus], channels[bus] = block, chosen
        seen = identifiers & _identifiers(block)
        lines.append(
            f"bus '{bus}' is channel '{chosen}': {len(block)} frames, "
            f"{len(seen)} of {len(identifiers)} known identifiers"
        )
    if not found:
        raise BadInputError(
            "no frame in the log belongs to a device of the bench",
            fix=f"give the bench file of these logs, or --dbc; there is: {listed(frames, known)}",
        )
    return found, lines, channels


def _guessed(
    frames: Frames, bus: str, identifiers: set[int], names: set[str], known: Mapping[str, set[int]]
) -> str | None:
    """The channel of the bus's name, else the one with most of its identifiers."""
    for channel in frames.names:
        if channel in names:
            return channel
    seen = {}
    for channel in frames.names:
        block = frames.of(channel)
        if block is not None:
            seen[channel] = len(identifiers & _identifiers(block))
    most = max(seen.values(), default=0)
    best = [channel for channel, count in seen.items() if count == most]
    if most and len(best) > 1:
        raise BadInputError(
            f"bus '{bus}' may be channel {' or '.join(best)}",
            fix=f"{_PICK}; there is: {listed(frames, known)}",
        )
    return best[0] if most else None


def listed(frames: Frames, known: Mapping[str, set[int]]) -> str:
    """What is in the logs, for a message: channel, frames, identifiers, known ones."""
    return "; ".join(_described(frames, known))


def _described(frames: Frames, known: Mapping[str, set[int]]) -> Iterator[str]:
    for (file, channel), block in frames.channels.items():
        identifiers = _identifiers(block)
        of = [f"{len(identifiers & ids)} of bus '{bus}'" for bus, ids in known.items() if identifiers & ids]
        few = ", ".join(f"0x{number:03X}" for number in sorted(identifiers)[:6])
        more = ", …" if len(identifiers) > 6 else ""
        yield (
            f"channel '{channel}' of {printable(Path(file).name)}: {len(block)} frames, "
            f"{len(identifiers)} standard identifiers ({few}{more}), {', '.join(of) or 'none known'}"
        )


def _identifiers(block: FrameBlock) -> set[int]:
    """Identifiers of 11 bits."""
    plain = block["flags"] & (EXTENDED | ERROR_FRAME) == 0
    return set(np.unique(block["id"][plain]).tolist())
