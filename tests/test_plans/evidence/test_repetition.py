"""Values that repeat: frozen ones are found, live ones are not."""

from __future__ import annotations

import numpy as np
import pytest

from test_plans import Array
from test_plans.evidence import Repetition, frozen_channels
from tests.test_plans.signals import STEP, recording_of, time_axis

TIME = time_axis()
DRAWS = np.random.default_rng(3)


def rounded(values: Array, step: float) -> Array:
    return np.asarray(np.rint(values / step) * step)


def torque(noise: float, resolution: float) -> Array:
    moving = np.where(STEP.step_s > TIME, 0.0, 326.0 * (1 - np.exp(-(TIME - STEP.step_s) / 0.1)))
    return rounded(moving + DRAWS.normal(0.0, noise, len(TIME)), resolution)


def frozen_from(values: Array, start_s: float, for_s: float) -> Array:
    changed = values.copy()
    first = int(np.searchsorted(TIME, start_s - 1e-9))
    last = int(np.searchsorted(TIME, start_s + for_s - 1e-9))
    changed[first:last] = changed[first]
    return changed


@pytest.mark.parametrize("for_s", [0.06, 0.5, 15.0])
def test_a_noisy_channel_that_stands_still_was_not_measured(for_s: float) -> None:
    values = frozen_from(torque(0.5, 0.01), 5.0, for_s)
    found = frozen_channels(recording_of(TIME, shaft_torque_nm=values), STEP)
    assert set(found) == {"shaft_torque_nm"}
    assert found["shaft_torque_nm"].start_s == pytest.approx(5.0, abs=1e-6)
    assert found["shaft_torque_nm"].duration_s == pytest.approx(for_s, abs=0.0015)
    assert "repeats bit for bit" in str(found["shaft_torque_nm"])


@pytest.mark.parametrize(
    ("noise", "resolution"), [(0.5, 0.01), (0.5, 0.5), (0.1, 1.0), (0.0, 0.01), (0.0, 5.0)]
)
def test_a_live_channel_is_alive_however_coarse_it_is(noise: float, resolution: float) -> None:
    request = np.where(STEP.step_s > TIME, 0.0, 40.0)
    recording = recording_of(TIME, shaft_torque_nm=torque(noise, resolution), motor_torque_ref_nm=request)
    assert frozen_channels(recording, STEP) == {}


def test_a_held_sample_of_10_ms_is_no_frozen_one() -> None:
    values = torque(0.5, 0.01)
    held = np.repeat(values[::10], 10)[: len(values)]
    assert frozen_channels(recording_of(TIME, shaft_torque_nm=held), STEP) == {}


def test_without_noise_a_neighbour_that_moves_shows_it() -> None:
    request = np.where(STEP.step_s > TIME, 0.0, 20.0 + 20.0 * np.sin(2 * np.pi * TIME))
    frozen = np.full(len(TIME), 7.25)
    both = recording_of(TIME, shaft_torque_nm=frozen, motor_torque_ref_nm=request)
    assert "while motor_torque_ref_nm moved" in str(frozen_channels(both, STEP)["shaft_torque_nm"])
    still = recording_of(TIME, shaft_torque_nm=frozen, motor_torque_ref_nm=np.full(len(TIME), 20.0))
    assert frozen_channels(still, STEP) == {}


def test_what_froze_before_the_segment_and_lives_in_it_is_measured() -> None:
    values = frozen_from(torque(0.5, 0.01), 0.5, 1.0)
    assert frozen_channels(recording_of(TIME, shaft_torque_nm=values), STEP) == {}


def test_blocks_give_what_the_whole_gives() -> None:
    values = frozen_from(torque(0.5, 0.01), 5.0, 0.2)[: int(5.1 / 0.001)]
    whole, blocks = Repetition(1), Repetition(1)
    whole.look(values[:, np.newaxis])
    for part in np.array_split(values, 97):
        blocks.look(part[:, np.newaxis])
    assert whole.runs.tolist() == blocks.runs.tolist()
    assert whole.runs[0] in (98, 99)  # to the end of what was looked at
    assert whole.noisy.tolist() == blocks.noisy.tolist() == [True]
