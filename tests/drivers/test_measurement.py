import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers import Binding, FrameSource, SampleAssembler
from hil.core.frames import FRAME
from hil.core.signals import Signal

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
