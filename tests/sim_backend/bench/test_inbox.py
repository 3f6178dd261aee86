"""What hosts have sent comes out in order, each thing once, and ends a batch where it has to."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from sim_backend.bench._outgoing import Inbox

REQUEST = ("rmcu", 0x100)
FRAMES = st.lists(
    st.tuples(st.integers(0, 30), st.sampled_from([REQUEST, ("rmcu", 0x101), ("dyno", 0x100)])), max_size=40
).map(lambda frames: sorted(frames, key=lambda frame: frame[0]))


@given(FRAMES)
def test_every_frame_comes_out_once_in_order_before_its_sample(frames):
    inbox = Inbox(REQUEST)
    for number, (sample, (bus, frame_id)) in enumerate(frames):
        inbox.put(sample, bus, frame_id, bytes([number]))
    first, came = 0, []
    while first < 31:
        came += [(first, sent.payload) for sent in inbox.until(first)]
        end = inbox.next_break(first + 8)
        samples, payloads = inbox.requests_before(end)
        came += zip(samples.tolist(), payloads.tolist(), strict=True)
        first = end
    assert [number for _, number in came] == list(range(len(frames)))
    # a request inside of a batch has the sample that it comes before; all else ends the batch there
    assert [sample for sample, _ in came] == [sample for sample, _ in frames]


def test_a_batch_ends_before_what_is_no_request():
    inbox = Inbox(REQUEST)
    inbox.put(3, *REQUEST, b"\x01")
    inbox.put(5, "rmcu", 0x101, b"\x02\x03")
    assert inbox.next_break(10) == 5
    assert inbox.next_break(4) == 4
    samples, payloads = inbox.requests_before(5)
    assert (samples.tolist(), payloads.tolist()) == ([3], [1])
    (sent,) = inbox.until(5)
    assert (sent.bus, sent.frame_id, sent.data) == ("rmcu", 0x101, b"\x02\x03")
    assert inbox.next_break(10) == 10
