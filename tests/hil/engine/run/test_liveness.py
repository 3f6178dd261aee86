"""The watch on frozen values, sample by sample."""

from __future__ import annotations

import numpy as np
import pytest

from drivers import Samples, Stream
from hil.core.errors import BenchError
from hil.engine.run.liveness import LivenessWatch
from test_plans import Array

PERIOD_S = 0.001
STATUS = Stream("status", "bus 'rmcu'", ("motor_speed_rad_s", "motor_torque_ref_nm"), ("", ""), PERIOD_S)
DYNO = Stream("dyno", "bus 'dyno'", ("wheel_speed_left_rad_s", "shaft_torque_left_nm"), ("", ""), PERIOD_S)


class Axle:
    """Samples of both streams, block by block."""

    def __init__(self, noise: float) -> None:
        self.watch = LivenessWatch([STATUS, DYNO])
        self._noise, self._draws, self._time_s = noise, np.random.default_rng(2), 0.0
        self.torque = 0.0
        self.frozen: float | None = None

    def pass_time(self, duration_s: float, block: int = 10) -> None:
        for _ in range(round(duration_s / PERIOD_S / block)):
            time: Array = self._time_s + PERIOD_S * np.arange(block, dtype=float)
            self._time_s += PERIOD_S * block
            noise = self._draws.normal(0.0, self._noise, (block, 3)) if self._noise else np.zeros((block, 3))
            torque = np.full(block, self.torque)
            shaft = 4.0 * torque + np.round(noise[:, 1], 3)
            shaft = shaft if self.frozen is None else np.full(block, self.frozen)
            speed = np.round(time + noise[:, 0], 4)
            self.watch.take(Samples(STATUS, time, np.column_stack([speed, torque])))
            self.watch.take(Samples(DYNO, time, np.column_stack([speed / 8 + noise[:, 2], shaft])))
            self.watch.refuse_frozen()


def test_noise_that_stops_ends_the_run_within_60_ms() -> None:
    axle = Axle(0.5)
    axle.pass_time(0.3)
    axle.frozen = 7.0
    axle.pass_time(0.04)
    with pytest.raises(BenchError, match="shaft_torque_left_nm repeats bit for bit for 5. ms") as caught:
        axle.pass_time(0.02)
    assert "bus 'dyno'" in caught.value.where


def test_a_channel_without_noise_may_stand_still_while_nothing_moves_it() -> None:
    axle = Axle(0.0)
    axle.torque = 10.0
    axle.pass_time(2.0)


def test_without_noise_a_neighbour_that_moves_ends_the_run() -> None:
    axle = Axle(0.0)
    axle.torque = 10.0
    axle.pass_time(0.3)
    axle.frozen = 40.0
    axle.torque = 20.0
    axle.pass_time(0.06)
    with pytest.raises(BenchError, match="while motor_torque_ref_nm moves"):
        axle.pass_time(0.05)


def test_what_stands_still_before_there_is_noise_is_not_known() -> None:
    axle = Axle(0.5)
    axle.frozen = 0.0
    axle.pass_time(1.0)
