"""Every frame of a log ends in exactly one count."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from hil.core.can.frames import ERROR_FRAME, EXTENDED, frames, joined
from hil.core.can_logs import CanLog
from hil.engine.replay._counts import counted


def test_frames_are_decoded_short_unknown_errors_or_refused() -> None:
    block = joined(
        [
            frames(0x100, 1, 8, 0.0),
            frames(0x100, 1, 2, 1.0),
            frames(0x200, 1, 8, 2.0),
            frames(0x200, 1, 8, 3.0, flags=EXTENDED),
            frames(0x100, 0, 0, 4.0, flags=ERROR_FRAME),
        ]
    )
    log = CanLog(Path("a.log"), {"1": block}, left_out={"remote frames": 3})
    found = counted([log], [(block, [0x100])], short=1)
    assert found.as_json() == {
        "all": 8,
        "decoded": 1,
        "short": 1,
        "of_no_message": 2,
        "identifiers_of_no_message": {"0x200": 1, "0x00000200x": 1},
        "error": 1,
        "refused": {"remote frames": 3},
    }
    assert found.in_words() == [
        "1 frame is shorter than its message: what it holds was taken",
        "2 frames are of no message that is described: 0x200 (1), 0x00000200x (1)",
        "1 error frame",
        "3 remote frames were left out",
    ]


@given(st.lists(st.tuples(st.integers(0, 5), st.sampled_from([0, EXTENDED, ERROR_FRAME])), min_size=1))
def test_counts_add_up(kinds: list[tuple[int, int]]) -> None:
    block = joined([frames(i, 0, 8, float(n), flags=flags) for n, (i, flags) in enumerate(kinds)])
    found = counted([CanLog(Path("a"), {"1": block})], [(block, [1, 2])], short=0)
    assert found.all == len(kinds)
    assert found.decoded == int(np.sum((block["id"] >= 1) & (block["id"] <= 2) & (block["flags"] == 0)))
