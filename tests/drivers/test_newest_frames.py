"""The newest frame of each kind: received, of that kind, and whole."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from drivers import NewestFrames
from hil.core.can.frames import ERROR_FRAME, EXTENDED, FRAME, SENT_BY_HOST, frames, joined
from hil.core.can.signals import Signal


def byte_from(bit: int) -> Signal:
    return Signal("value", shift=bit, length=8)


def test_one_that_was_sent_extended_or_broken_is_not_the_newest() -> None:
    block = joined(
        [
            frames(5, 1, 8, 0.1),
            frames(5, 2, 8, 0.2),
            frames(5, 3, 8, 0.3, flags=SENT_BY_HOST),
            frames(5, 4, 8, 0.4, flags=EXTENDED),
            frames(5, 5, 8, 0.5, flags=ERROR_FRAME),
            frames(6, 6, 8, 0.6),
        ]
    )
    newest = NewestFrames({7: (), 6: (), 5: ()})
    assert newest.of(block) == [None, (0.6, 6), (0.2, 2)]
    assert newest.of(block[2:5]) == [None, None, None]
    assert newest.of(block[:0]) == [None, None, None]


def test_a_frame_without_the_last_bit_that_is_read_of_it_is_passed_over() -> None:
    newest = NewestFrames({5: (byte_from(0), byte_from(17))})  # up to bit 24, in the fourth byte
    block = joined([frames(5, 1, 4, 0.1), frames(5, 2, 3, 0.2), frames(5, 3, 0, 0.3)])
    assert newest.of(block) == [(0.1, 1)]
    assert newest.of(block[1:]) == [None]


@given(
    st.lists(
        st.tuples(
            st.sampled_from([4, 5, 6]),
            st.sampled_from([0, 0, SENT_BY_HOST, EXTENDED, ERROR_FRAME]),
            st.integers(0, 8),
            st.integers(0, 2**64 - 1),
        ),
        max_size=12,
    )
)
def test_it_is_what_a_look_at_each_frame_finds(rows: list[tuple[int, int, int, int]]) -> None:
    block = np.array(
        [
            (0.001 * place, number, flags, length, data)
            for place, (number, flags, length, data) in enumerate(rows)
        ],
        FRAME,
    )
    expected = []
    for wanted, least in ((5, 2), (4, 0)):
        fitting = [
            (0.001 * place, data)
            for place, (number, flags, length, data) in enumerate(rows)
            if number == wanted and not flags and length >= least
        ]
        expected.append(fitting[-1] if fitting else None)
    assert NewestFrames({5: (byte_from(8),), 4: ()}).of(block) == expected
