"""Channels that are broken in themselves are named."""

import dataclasses

import numpy as np
import pytest

from hil.analysis.diagnosis.data.broken_channels import coarse, refuse_broken_channels
from hil.core.errors import BadInputError
from tests.hil.analysis.diagnosis.one_recording import NOISE, one_trace


def test_a_good_recording_is_not_refused() -> None:
    assert refuse_broken_channels([one_trace()], np.array(NOISE)) == []


@pytest.mark.parametrize(
    ("column", "channel", "fault"),
    [(0, "motor_speed_rad_s", "dead"), (2, "shaft_torque_nm", "dead"), (0, "motor_speed_rad_s", "frozen")],
)
def test_a_broken_channel_is_named(column: int, channel: str, fault: str) -> None:
    trace = one_trace()
    samples = trace.samples.copy()
    samples[(slice(None) if fault == "dead" else slice(1000, 1500)), column] = 3.0
    with pytest.raises(BadInputError, match=f"{channel} looks {fault}"):
        refuse_broken_channels([dataclasses.replace(trace, samples=samples)], np.array(NOISE))


def test_few_levels_are_coarse() -> None:
    trace = one_trace()
    assert not coarse(trace, 0)
    assert coarse(dataclasses.replace(trace, samples=np.sign(trace.samples)), 0)


@pytest.mark.parametrize("push", [0.2, 4.0])
def test_a_speed_alone_may_stand_still_where_torque_moves_it_by_less_than_its_rounding(push: float) -> None:
    moving = one_trace()
    alone = moving.samples * np.array([1.0, np.nan, np.nan])
    step = float(np.ptp(alone[:, 0])) / 8.0
    rounded = np.round(alone / step) * step
    blocks = np.full_like(moving.measured, np.nan)
    blocks[:, 0] = moving.measured[:, 0]
    seen = dataclasses.replace(moving, samples=rounded, measured=blocks)
    still = np.zeros_like(rounded) * np.array([1.0, np.nan, np.nan])
    held = dataclasses.replace(seen, samples=still, measured=0.0 * blocks, torque=push * moving.torque)
    noise = np.array([step / np.sqrt(12.0), np.nan, np.nan])
    if push < 1.0:
        refuse_broken_channels([seen, held], noise)
    else:
        with pytest.raises(BadInputError, match="motor_speed_rad_s looks dead"):
            refuse_broken_channels([seen, held], noise)
