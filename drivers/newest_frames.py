"""The newest frames of a block with certain identifiers: what their senders are like now."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from hil.core.can.frames import ERROR_FRAME, EXTENDED, SENT_BY_HOST, FrameBlock
from hil.core.can.signals import Signal
from hil.core.runtime.compiled import compiled

_OTHERS = SENT_BY_HOST | EXTENDED | ERROR_FRAME


def least_bytes(signals: Iterable[Signal]) -> int:
    """How many bytes a frame must have for all of these signals to be in it: half a frame says nothing."""
    return max((_bytes_of(signal) for signal in signals), default=0)


def _bytes_of(signal: Signal) -> int:
    return 8 - signal.shift // 8 if signal.big_endian else -(-(signal.shift + signal.length) // 8)


class NewestFrames:
    """Looks for the last received frame of each kind that is whole.

    Args:
        signals: those read of a frame, by its identifier.
    """

    def __init__(self, signals: Mapping[int, Iterable[Signal]]) -> None:
        self._ids = np.array(list(signals), np.int64)
        self._least = np.array([least_bytes(several) for several in signals.values()], np.int64)
        self._places = np.zeros(len(signals), np.int64)
        self._times_s = np.zeros(len(signals))
        self._payloads = np.zeros(len(signals), np.uint64)

    def of(self, block: FrameBlock) -> list[tuple[float, int] | None]:
        """Time and payload for each identifier, in the order in which they were given; None without one."""
        # Compiled code fills arrays that are there: making some to give back takes it longer than the search.
        _last(block, self._ids, self._least, self._places, self._times_s, self._payloads)
        every = zip(self._places.tolist(), self._times_s.tolist(), self._payloads.tolist(), strict=True)
        return [(time_s, payload) if place >= 0 else None for place, time_s, payload in every]


@compiled
def _last(block, wanted, least, places, times_s, payloads):  # type: ignore[no-untyped-def]
    for entry in range(wanted.shape[0]):
        places[entry] = -1
        for place in range(block.shape[0] - 1, -1, -1):
            frame = block[place]
            if frame.id != wanted[entry] or frame.length < least[entry] or frame.flags & _OTHERS:
                continue
            places[entry], times_s[entry], payloads[entry] = place, frame.time_s, frame.data
            break
