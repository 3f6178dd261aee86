"""From counted frames to sample numbers: a counter or a count says which sample, arrival only the turn."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from drivers.sample_clock import Array, Numbers, SampleClock

_AWAITED_S = 0.2  # a frame that is late by more than a turn may be followed, for so long, by one that is not
_KEPT = 2000  # counted frames that followers may still be asked about
_WHOLE = 0.3  # sample times by which a gap may differ from a whole number of samples
_PROOF = 5  # frames at the end of a run that must agree on a loss
_NOTHING = np.zeros(0, np.int64)
_NO_FATES = np.zeros(0, np.int8)

#: What becomes of a frame: it has a number of its own, it is a copy of another, nobody can say which it is.
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
        self._counts, self._arrivals = _NOTHING, np.zeros(0)
        self._behind = 0
        self.stepped_s = (
            0.0  # what a gap in time was more than whole samples: then none was lost, time passed
        )
        # What followers are numbered by: counts that rose, and the samples' numbers
        self.risen: tuple[Numbers, Numbers] = (_NOTHING, _NOTHING)

    def add(self, counts: Numbers, arrivals_s: Array) -> None:
        """Take frames as they came: counts without turns, and arrivals on the bench clock."""
        self._counts = np.concatenate([self._counts, counts])
        self._arrivals = np.concatenate([self._arrivals, arrivals_s])

    def settle(self, *, everything: bool = False) -> tuple[Numbers, Fates]:
        """Numbers of those frames, first come first, whose turn is certain, and what becomes of each.

        Args:
            everything: nothing more will come.
        """
        counts, arrivals = self._counts, self._arrivals
        if not len(counts):
            return _NOTHING, _NO_FATES
        if not self._clock.begun:
            self._clock.guess(counts, arrivals)
        turns, end, fates = self._turns(counts, arrivals, everything)
        numbers = counts[:end] + self._behind + self.turn * turns[:end]
        fates = fates[:end]
        placed = fates == PLACED
        if end:
            self._behind += self.turn * int(turns[end - 1])
        self._counts, self._arrivals = counts[end:], arrivals[end:]
        self._clock.learn(numbers[placed], arrivals[:end][placed])
        self._note_risen(counts[:end][placed], numbers[placed])
        return numbers, fates

    def _turns(self, counts: Numbers, arrivals: Array, everything: bool) -> tuple[Numbers, int, Fates]:
        """Turns that each frame lacks, how many frames are certain, and which are of one turn only."""
        clock = self._clock
        late_s = arrivals - clock.times(counts + self._behind)
        turn_s = self.turn * clock.period_s
        behind = np.rint(late_s / turn_s).astype(np.int64)
        behind[late_s <= 0.5 * turn_s + 2 * clock.spread_s] = 0
        turns = np.minimum.accumulate(behind[::-1])[::-1]
        fates = np.zeros(len(turns), np.int8)
        if not turns[-1]:
            return turns, len(turns), fates  # the newest is in time: nobody lacks anything
        young = int(np.searchsorted(np.maximum.accumulate(arrivals), np.max(arrivals) - _AWAITED_S))
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
        further apart all that the lost ones left, if none of the followers is missing, else nobody can say
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
        after = np.searchsorted(risen_counts, keys, side="right")
        end = int(np.searchsorted(after, len(numbers)))
        first, last = np.searchsorted(after, after[:end]), np.searchsorted(after, after[:end], side="right")
        places = np.arange(end)
        before = numbers[np.maximum(after[:end] - 1, 0)]
        missing = numbers[after[:end]] - before
        if opens:
            found, turn_of = before + places - first, places - first
        else:
            found, turn_of = before + missing - (last - 1 - places), last - 1 - places
        fates = np.where(turn_of < missing, PLACED, COPY).astype(np.int8)
        fates[(after[:end] == 0) | (last - first < missing)] = DOUBTFUL
        if opens and len(keys) == end + 1 and keys[-1] == risen_counts[-1]:
            return np.append(found, numbers[-1]), np.append(fates, np.int8(PLACED))
        return found, fates

    def forget(self) -> None:
        """Every follower has been asked."""
        self.risen = self.risen[0][-_KEPT:], self.risen[1][-_KEPT:]
