"""A frame is known by its number and its kind: 0x110 with 29 bits is not 0x110 with 11."""

from __future__ import annotations

import numpy as np
import pytest

from drivers import Binding, FrameSource, NewestFrames, SampleAssembler
from hil.core.can.frames import ERROR_FRAME, EXTENDED, FRAME, SENT_BY_HOST, FrameBlock, standard
from hil.core.can.signals import Signal
from hil.engine.bench.ranges import Limits
from hil.engine.run.limits import LimitWatch

SPEED = Binding("rmcu", 0x110, Signal("MotorSpeed", 0, 16, scale=0.1, unit="rad/s"), "motor_speed_rad_s")
LIMITS = Limits(
    motor_torque_nm=100, driving_torque_nm=500, shaft_torque_nm=900, motor_speed_rad_s=50,
    wheel_speed_rad_s=50, vehicle_speed_m_s=30,
)  # fmt: skip


def block(*rows: tuple[float, int, int, int]) -> FrameBlock:
    """Frames of (time_s, flags, length, payload), all with the identifier 0x110."""
    return np.array([(time, 0x110, flags, length, data) for time, flags, length, data in rows], FRAME)


@pytest.mark.parametrize("flags", [EXTENDED, ERROR_FRAME, EXTENDED | ERROR_FRAME])
def test_another_kind_of_frame_with_the_same_number_is_not_decoded(flags: int) -> None:
    mixed = block(
        (0.000, 0, 8, 100), (0.0005, flags, 8, 60_000), (0.001, 0, 8, 101), (0.0015, flags, 8, 60_000)
    )
    assert list(standard(mixed)["data"]) == [100, 101]
    assert NewestFrames({0x110: ()}).of(mixed) == [(0.001, 101)]
    source = FrameSource([SPEED], 1e-3)
    source.take("rmcu", mixed)
    assembler = SampleAssembler(source.streams, 1e-3)
    for samples in source.samples():
        assembler.add(samples)
    assert assembler.rows(everything=True)[:, 1] == pytest.approx([10.0, 10.1])
    watch = LimitWatch(source.streams, LIMITS)
    watch.active = True
    for start in range(20):
        later = mixed.copy()
        later["time_s"] += 0.002 * start
        source.take("rmcu", later)  # 6,000 rad/s in the other frames trips nothing
        for samples in source.samples():
            watch.take(samples, 0.0)
    assert watch.largest["motor_speed_rad_s"] == pytest.approx(10.1)


def test_what_the_host_sent_stays_among_standard_frames() -> None:
    whole = block((0.0, SENT_BY_HOST, 8, 1))
    assert standard(whole) is whole
