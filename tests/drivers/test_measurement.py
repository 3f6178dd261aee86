import tracemalloc

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers import Binding, Counting, FrameSource, SampleAssembler, Samples, Stream
from hil.core.can.frames import FRAME
from hil.core.can.signals import Signal

SIGNAL = Signal("value", 0, 32)
BINDINGS = [
    Binding("rmcu", 1, SIGNAL, "motor_speed_rad_s"),
    Binding("dyno", 2, SIGNAL, "shaft_torque_left_nm"),
    Binding("dyno", 3, SIGNAL, "shaft_torque_right_nm"),
]


def frames(frame_id, stamps, values=None):
    block = np.zeros(len(stamps), FRAME)
    block["time_s"], block["id"], block["length"] = stamps, frame_id, 8
    block["data"] = np.arange(len(stamps)) if values is None else values
    return block


def assemble(rmcu, left, right, chunks=1):
    source = FrameSource(BINDINGS, 1e-3)
    assembler = SampleAssembler(source.streams, 1e-3)
    rows = []
    for part in range(chunks):
        times = rmcu["time_s"][part * len(rmcu) // chunks : (part + 1) * len(rmcu) // chunks]
        for bus, block in (("rmcu", rmcu), ("dyno", left), ("dyno", right)):
            first, last = times[0] - 0.5e-3, times[-1] + 0.5e-3
            source.take(bus, block[(block["time_s"] >= first) & (block["time_s"] < last)])
        for samples in source.samples():
            assembler.add(samples)
        rows.append(assembler.rows(everything=part == chunks - 1))
    return assembler.names, np.concatenate(rows)


@given(
    offset=st.floats(-0.45e-3, 0.45e-3),
    jitter=st.floats(0, 0.02e-3),
    chunks=st.integers(1, 7),
    seed=st.integers(0, 100),
)
def test_frames_of_the_same_millisecond_make_one_sample(offset, jitter, chunks, seed):
    random = np.random.default_rng(seed)
    base = 5.0 + np.arange(300) * 1e-3

    def stamps(shift):
        return base + shift + random.uniform(-jitter, jitter, 300)

    names, rows = assemble(frames(1, stamps(0)), frames(2, stamps(offset)), frames(3, stamps(offset)), chunks)
    np.testing.assert_allclose(rows[:, 0], np.arange(300) * 1e-3, atol=1e-9)
    np.testing.assert_array_equal(rows[:, names.index("motor_speed_rad_s")], np.arange(300))
    np.testing.assert_array_equal(rows[:, names.index("shaft_torque_nm")], 2 * np.arange(300))


def test_a_lost_frame_of_the_time_base_is_a_gap_and_of_another_a_neighbour():
    base = np.arange(100) * 1e-3
    keep = np.arange(100) != 50
    names, rows = assemble(frames(1, base[keep], np.arange(100)[keep]), frames(2, base), frames(3, base))
    assert len(rows) == 99
    np.testing.assert_allclose(np.diff(rows[:, 0])[49], 2e-3)
    names, rows = assemble(frames(1, base), frames(2, base[keep], np.arange(100)[keep]), frames(3, base))
    assert rows[50, names.index("shaft_torque_left_nm")] in (49, 51)


def test_a_device_that_falls_silent_gives_missing_values_not_old_ones():
    base = np.arange(400) * 1e-3
    names, rows = assemble(frames(1, base), frames(2, base[:100]), frames(3, base), chunks=4)
    left = rows[:, names.index("shaft_torque_left_nm")]
    assert len(rows) == 400
    assert np.isnan(left[103:]).all()
    assert not np.isnan(left[:100]).any()
    assert np.isnan(rows[200, names.index("shaft_torque_nm")])


def test_nothing_yet_is_no_rows():
    streams = FrameSource(BINDINGS, 1e-3).streams
    assert SampleAssembler(streams, 1e-3).rows().shape[0] == 0
    with pytest.raises(ValueError, match="not in list"):
        SampleAssembler(streams, 1e-3).names.index("wheel_speed_rad_s")


def test_what_is_kept_does_not_grow_with_the_run_not_even_of_a_stream_that_is_there_for_its_count():
    value = Stream("values", "here", ("value",), ("N m",), 1e-3, counting=Counting("8 bits", 256))
    count = Stream("a count", "here", (), (), 1e-3, counting=Counting("8 bits of another", 256))
    assembler = SampleAssembler([value, count], 1e-3)

    def play(first: int) -> int:
        numbers = np.arange(first, first + 1000)
        for stream in (value, count):
            values = np.zeros((1000, len(stream.channels)))
            assembler.add(Samples(stream, numbers.astype(float) / 1000, values, numbers % 256))
        return len(assembler.rows())

    tracemalloc.start()
    try:
        rows = play(0) + play(1000)
        held = tracemalloc.get_traced_memory()[0]
        for second in range(2, 40):
            rows += play(1000 * second)
        grown = tracemalloc.get_traced_memory()[0] - held
    finally:
        tracemalloc.stop()
    assert rows > 39_000
    assert grown < 38 * 1000 * 8 / 2  # numbers alone would be 8 bytes of each sample
