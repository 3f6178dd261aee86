"""What was read of a log of CAN frames."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt

from hil.core.frames import ERROR_FRAME, EXTENDED, FRAME, SENT_BY_HOST, FrameBlock

#: What no recording has a place for; names as users are told them.
REMOTE, LONG = "remote frames", "CAN FD frames of more than 8 bytes"
IMPOSSIBLE = "frames with an identifier or a stamp that none can have"
SHORT = "frames with fewer bytes than they say"
LONGEST_DATA = 8


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
