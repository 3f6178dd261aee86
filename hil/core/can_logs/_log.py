"""What was read of a log of CAN frames."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import numpy as np
import numpy.typing as npt

from hil.core.can.frames import ERROR_FRAME, EXTENDED, FRAME, SENT_BY_HOST, FrameBlock
from hil.core.errors import BadInputError

#: What no recording has a place for; names as users see them.
REMOTE, LONG = "remote frames", "CAN FD frames of more than 8 bytes"
IMPOSSIBLE = "frames with an identifier or a stamp that none can have"
SHORT = "frames with fewer bytes than they say"
LONGEST_DATA = 8


#: What stamps mean where a file leaves it open: it is not stated; what goes back was recorded later, or was
#: written out of order; those of an ASC's trigger blocks count from the log's begin, or from the block's.
Stamps = Literal["", "append", "sort", "log", "block"]
_UNREMARKABLE_S = 10.0  # that frames were sorted which stand so close need not be reported
_LATE_S = 0.1  # by which a frame may stand behind newer ones
_PAUSE_S, _ANOTHER_CLOCK_S = 60.0, 86_400.0  # that a log skips: is reported, is refused


class LogClock:
    """Stamps in the order of the file: a log's writer may be late with some, but none goes back for long."""

    def __init__(self, stamps: Stamps) -> None:
        self._stamps = stamps
        self._newest_s, self._offset_s = -math.inf, 0.0
        self._count = self._backs = self._first = 0
        self._back_s = self._ahead_s = 0.0
        self._ahead_at = 0

    def time_s(self, stamp_s: float) -> float:
        """The time of the next frame."""
        self._count += 1
        time_s = stamp_s + self._offset_s
        if time_s < self._newest_s - _LATE_S:
            self._backs += 1
            self._first = self._first or self._count
            self._back_s = max(self._back_s, self._newest_s - time_s)
            if self._stamps == "append":
                self._offset_s += self._newest_s - time_s
                time_s = self._newest_s
        elif time_s - self._newest_s > max(self._ahead_s, _PAUSE_S) and self._count > 1:
            self._ahead_s, self._ahead_at = time_s - self._newest_s, self._count
            if self._stamps == "append" and self._ahead_s > _ANOTHER_CLOCK_S:
                self._offset_s += self._newest_s - time_s
                time_s = self._newest_s
        self._newest_s = max(self._newest_s, time_s)
        return time_s

    def settled(self, where: str) -> list[str]:
        """What was done, a sentence each.

        Raises:
            BadInputError: stamps go back, or skip a day or more, and it is not stated what that means.
        """
        skipped = self._skipped(where)
        if not self._backs or (self._stamps == "sort" and self._back_s < _UNREMARKABLE_S):
            return skipped
        what = f"its stamps go back by up to {self._back_s:.3g} s, first at frame {self._first}"
        if self._stamps not in ("append", "sort"):
            fix = (
                "--stamps append: what follows was recorded later; --stamps sort: it was written out of order"
            )
            raise BadInputError(what, where=where, fix=fix)
        done = "what follows was put behind" if self._stamps == "append" else "frames were sorted"
        return [f"{what}: {done}", *skipped]

    def _skipped(self, where: str) -> list[str]:
        if not self._ahead_s:
            return []
        what = f"its stamps skip {self._ahead_s:.6g} s at frame {self._ahead_at}"
        if self._ahead_s <= _ANOTHER_CLOCK_S or self._stamps == "sort":
            return [f"{what}: no frame lies between"]
        if self._stamps == "append":
            return [f"{what}: what follows was put behind"]
        raise BadInputError(
            f"{what}, as where a clock is set during a recording",
            where=where,
            fix="--stamps append: what follows came next; --stamps sort: nothing was recorded between",
        )


@dataclass(frozen=True)
class CanLog:
    """Frames by the log's own name of each channel, in order of time.

    Attributes:
        began_ns: wall-clock time at which stamps are 0, ns since 1970; None: the log does not say.
        left_out: how many frames of which kind no recording has a place for.
        remarks: what else a reader of the results must know, a sentence each.
    """

    path: Path
    channels: Mapping[str, FrameBlock]
    began_ns: int | None = None
    left_out: Mapping[str, int] = field(default_factory=dict)
    remarks: Sequence[str] = ()

    @property
    def count(self) -> int:
        """Frames of all channels."""
        return sum(len(block) for block in self.channels.values())


def ordered(block: FrameBlock) -> FrameBlock:
    """The frames in order of their stamps; those of one stamp as they stand."""
    times = block["time_s"]
    if len(times) > 1 and np.any(np.diff(times) < 0):
        return block[np.argsort(times, kind="stable")]
    return block


def block_of(
    times_s: npt.ArrayLike,
    ids: npt.ArrayLike,
    flags: npt.ArrayLike,
    lengths: npt.ArrayLike,
    data: npt.ArrayLike,
) -> FrameBlock:
    """Frames from columns of one length."""
    times = np.asarray(times_s, np.float64)
    block = np.empty(len(times), FRAME)
    block["time_s"], block["id"], block["flags"] = times, ids, flags
    block["length"], block["data"] = lengths, data
    return block


def flags_of(*, extended: bool, sent: bool, error: bool) -> int:
    """A frame's flags."""
    return EXTENDED * extended | SENT_BY_HOST * sent | ERROR_FRAME * error
