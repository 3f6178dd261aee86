"""From counted frames to sample numbers: a counter or a count says which sample, arrival only the turn."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from drivers.sample_clock import Array, Numbers, SampleClock
from hil.core.runtime.compiled import compiled

_AWAITED_S = 0.2  # a frame that is late by more than a turn may be followed, for so long, by one that is not
_KEPT = 500  # counted frames that followers may still be asked about
_WHOLE = 0.3  # sample times by which a gap may differ from a whole number of samples
_PROOF = 5  # frames at the end of a run that must agree on a loss
_NOTHING = np.zeros(0, np.int64)
_NO_FATES = np.zeros(0, np.int8)

#: What becomes of a frame: it has a number of its own, it is a copy of another, no one can say which it is.
PLACED, COPY, DOUBTFUL = 0, 1, 2
Fates = npt.NDArray[np.int8]


class FrameCount:
    """Numbers the frames that count a device's samples.

    Args:
        turn: values that the counter takes before it begins again; 1 if there is none and frames are
            counted.
        clock: learns from the numbers, and tells how late a frame is.

    A count that has lost a whole turn of frames (of one frame, where they are only counted) is behind for
    ever, a frame that was held up only for a while: frames are behind if every one that follows is late by
    the turn too. What came between the last frame in time before and the first in time after a loss could be
    either: it is left out.
    """

    def __init__(self, turn: int, clock: SampleClock) -> None:
        self.turn, self._clock = turn, clock
        self._behind = 0
        self.stepped_s = (
            0.0  # what a gap in time was more than whole samples: then none was lost, time passed
        )
        # What followers are numbered by: counts that rose, and the samples' numbers
        self.risen: tuple[Numbers, Numbers] = (_NOTHING, _NOTHING)

    def settle(
        self, counts: Numbers, arrival_times: Array, *, everything: bool = False
    ) -> tuple[Numbers, Fates]:
        """Numbers of those frames, first come first, whose turn is certain, and what becomes of each.

        Args:
            counts: without turns, as the frames came; those that were not certain before come again.
            arrival_times: of the frames, s, bench clock.
            everything: nothing more will come.
        """
        if not len(counts):
            return _NOTHING, _NO_FATES
        if not self._clock.started:
            self._clock.guess(counts, arrival_times)
        turns, end, fates = self._turns(counts, arrival_times, everything)
        numbers = counts[:end] + self._behind + self.turn * turns[:end]
        fates = fates[:end]
        placed = fates == PLACED
        if end:
            self._behind += self.turn * int(turns[end - 1])
        arrival_times, counts = arrival_times[:end], counts[:end]
        self._clock.learn(numbers[placed], arrival_times[placed])
        self._note_risen(counts[placed], numbers[placed])
        return numbers, fates

    def _turns(self, counts: Numbers, arrival_times: Array, everything: bool) -> tuple[Numbers, int, Fates]:
        """Turns that each frame lacks, how many frames are certain, and which are of one turn only."""
        clock = self._clock
        late_s = arrival_times - clock.times(counts + self._behind)
        turn_s = self.turn * clock.period_s
        behind = np.rint(late_s / turn_s).astype(np.int64)
        behind[late_s <= 0.5 * turn_s + 2 * clock.spread_s] = 0
        turns = np.minimum.accumulate(behind[::-1])[::-1]
        fates = np.zeros(len(turns), np.int8)
        if not turns[-1]:
            return turns, len(turns), fates  # the newest is in time: no one lacks anything
        young = int(np.searchsorted(np.maximum.accumulate(arrival_times), np.max(arrival_times) - _AWAITED_S))
        waits = young + int(np.argmax(turns[young:] > 0))
        if everything:
            if np.count_nonzero(behind[waits:] == turns[-1]) < _PROOF:
                turns[waits:] = turns[waits - 1] if waits else 0  # too few to speak of a loss
            waits = len(turns)
        for first in np.flatnonzero(np.diff(turns[:waits], prepend=0)):
            in_time = first + int(np.argmax(behind[first:] == turns[first]))
            fates[first:in_time] = DOUBTFUL
            rest_s = float(late_s[in_time] - turns[first] * turn_s)
            if abs(rest_s) > _WHOLE * clock.period_s + 2 * clock.spread_s:
                self.stepped_s = rest_s
        return turns, waits, fates

    def _note_risen(self, counts: Numbers, numbers: Numbers) -> None:
        """A frame that was overtaken, or came twice, says nothing of those around it."""
        if not len(counts):
            return
        before = np.maximum.accumulate(np.concatenate([self.risen[0][-1:], counts]))
        rose = (
            np.diff(before) > 0 if len(before) > len(counts) else np.diff(before, prepend=counts[0] - 1) > 0
        )
        risen_counts, risen_numbers = self.risen
        self.risen = (
            np.concatenate([risen_counts, counts[rose]]),
            np.concatenate([risen_numbers, numbers[rose]]),
        )

    def follow(self, keys: Numbers, *, opens: bool) -> tuple[Numbers, Fates]:
        """Numbers of frames that have no count of their own, and what becomes of each.

        Between two counted frames, one sample apart, lies one frame of each follower; between two that lie
        further apart all that the lost ones left, if none of the followers is missing, else no one can say
        which they are.

        Args:
            keys: for each frame, first come first, the newest count that had come before it.
            opens: the counted frame is the first of its sample, else the last.

        Returns:
            Of as many frames as are certain.
        """
        risen_counts, numbers = self.risen
        if not len(keys) or not len(numbers):
            return _NOTHING, _NO_FATES
        found, fates = np.empty_like(keys), np.empty(len(keys), np.int8)
        end = _follow(keys, risen_counts, numbers, opens, found, fates)
        return found[:end], fates[:end]

    def forget(self) -> None:
        """Every follower has been asked."""
        self.risen = self.risen[0][-_KEPT:], self.risen[1][-_KEPT:]


@compiled
def _follow(keys, counts, numbers, opens, found, fates):  # type: ignore[no-untyped-def]
    """Number frames between counted frames; how many of them are certain."""
    after = first = 0
    while first < len(keys):
        while after < len(counts) and counts[after] <= keys[first]:
            after += 1
        end = first + 1
        while end < len(keys) and (after == len(counts) or keys[end] < counts[after]):
            end += 1
        if after == len(counts):  # no one knows yet how many belong here, but the first one does
            if opens and end == first + 1 and keys[first] == counts[after - 1]:
                found[first], fates[first] = numbers[after - 1], PLACED
                return end
            return first
        missing = numbers[after] - numbers[after - 1] if after else 0
        for place in range(first, end):
            turn = place - first if opens else end - 1 - place
            found[place] = numbers[after - 1] + turn if opens else numbers[after] - turn
            fates[place] = PLACED if turn < missing else COPY
            if end - first < missing or after == 0:
                fates[place] = DOUBTFUL
        first = end
    return first
