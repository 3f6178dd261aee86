"""Blocks of frames: those sent stand where they belong, those that came keep their order."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from hil.core.can.frames import SENT_BY_HOST, frames, inserted

TIMES = st.lists(st.integers(0, 20).map(float), max_size=12)


@given(TIMES, TIMES)
def test_what_came_keeps_its_order_whatever_its_stamps_say(sent_s: list[float], came_s: list[float]) -> None:
    sent = frames(
        1, np.arange(len(sent_s), dtype=np.uint64), 8, np.sort(np.array(sent_s)), flags=SENT_BY_HOST
    )
    came = frames(2, np.arange(len(came_s), dtype=np.uint64), 8, np.array(came_s))
    both = inserted(sent, came)
    assert both[both["id"] == 1].tobytes() == sent.tobytes()
    assert both[both["id"] == 2].tobytes() == came.tobytes()
    for place in np.flatnonzero(both["id"] == 1):
        before = both[:place][both[:place]["id"] == 2]["time_s"]
        assert np.all(before < both["time_s"][place])
        after = both[place:][both[place:]["id"] == 2]["time_s"]
        assert not len(after) or after[0] >= both["time_s"][place]
