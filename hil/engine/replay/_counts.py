"""What became of every frame of a log: each ends in exactly one count."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from hil.core.can.dbc_messages import EXTENDED_BIT, keys_of
from hil.core.can.frames import ERROR_FRAME, FrameBlock
from hil.core.can_logs import CanLog

_MOST_NAMED = 8


@dataclass(frozen=True)
class FrameCounts:
    """Frames of all logs.

    Attributes:
        decoded: gave every signal that their message has.
        short: ended before a signal that should be in them; what they held was taken.
        unknown: of no message, by identifier: 29 bits as "0x1234567x", 11 as "0x123".
        errors: error frames.
        refused: no recording has a place for them, by kind: remote frames, CAN FD of more than 8 bytes.
    """

    decoded: int = 0
    short: int = 0
    unknown: Mapping[str, int] = field(default_factory=dict)
    errors: int = 0
    refused: Mapping[str, int] = field(default_factory=dict)

    @property
    def all(self) -> int:
        """Frames that were read."""
        further = (*self.unknown.values(), *self.refused.values())
        return self.decoded + self.short + self.errors + sum(further)

    def as_json(self) -> dict[str, Any]:
        """For `--json` and run.json; `all` is the sum of the others."""
        return {
            "all": self.all,
            "decoded": self.decoded,
            "short": self.short,
            "of_no_message": sum(self.unknown.values()),
            "identifiers_of_no_message": dict(self.unknown),
            "error": self.errors,
            "refused": dict(self.refused),
        }

    def in_words(self) -> list[str]:
        """What was not decoded, a sentence each."""
        lines = []
        if self.short == 1:
            lines.append("1 frame is shorter than its message: what it holds was taken")
        elif self.short:
            lines.append(f"{self.short} frames are shorter than their message: what they hold was taken")
        if self.unknown:
            most = sorted(self.unknown.items(), key=lambda one: -one[1])
            named = ", ".join(f"{identifier} ({count})" for identifier, count in most[:_MOST_NAMED])
            more = f" and {len(most) - _MOST_NAMED} more" if len(most) > _MOST_NAMED else ""
            count = sum(self.unknown.values())
            are = "1 frame is" if count == 1 else f"{count} frames are"
            lines.append(f"{are} of no message that is described: {named}{more}")
        if self.errors:
            lines.append("1 error frame" if self.errors == 1 else f"{self.errors} error frames")
        lines += [f"{count} {kind} were left out" for kind, count in self.refused.items()]
        return lines


def counted(
    logs: Iterable[CanLog], blocks: Iterable[tuple[FrameBlock, Iterable[int]]], short: int
) -> FrameCounts:
    """Counts of logs.

    Args:
        blocks: the frames of each channel, with the keys of the messages by which they were decoded.
        short: how many of them were too short.
    """
    decoded = errors = 0
    unknown: dict[str, int] = {}
    for block, known in blocks:
        broken = block["flags"] & ERROR_FRAME != 0
        errors += int(np.count_nonzero(broken))
        keys = keys_of(block)[~broken]
        found = np.isin(keys, np.fromiter(known, np.uint32))
        decoded += int(np.count_nonzero(found))
        for identifier, count in _by_identifier(keys[~found]):
            unknown[identifier] = unknown.get(identifier, 0) + count
    refused: dict[str, int] = {}
    for log in logs:
        for kind, count in log.left_out.items():
            refused[kind] = refused.get(kind, 0) + count
    return FrameCounts(decoded - short, short, unknown, errors, refused)


def _by_identifier(keys: npt.NDArray[np.uint32]) -> Iterable[tuple[str, int]]:
    values, counts = np.unique(keys, return_counts=True)
    for key, count in zip(values.tolist(), counts.tolist(), strict=True):
        number = key & ~EXTENDED_BIT
        yield (f"0x{number:08X}x" if key & EXTENDED_BIT else f"0x{number:03X}"), count
