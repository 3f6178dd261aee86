"""Limits of the request: gradients by hand, and a request that is withdrawn on ice."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.low_friction import on_the_road, slippery_axle
from benchmarks.play_crossing import LEAD
from drivers import parameters_of
from hil.core.controller import Controller, load_controller
from hil.core.controller.shaping import RequestLimits, SlipWithdrawal
from hil.fmu import Axle
from hil.plant.closed_loop import tick as T
from hil.plant.controller import Memory, build
from hil.plant.controller import memory as M
from hil.plant.controller.request_governor import govern

SHIPPED = load_controller(LEAD)
Array = np.ndarray


def governed(controller: Controller, requests: Array) -> Array:
    """What is followed of requests, N m, with wheels that do not slip."""
    memory = Memory()
    assert build(parameters_of(controller), memory) == 0
    return np.array([govern(memory.gains, memory.states, one, 10.0, 0.0) for one in requests])


def limited(**values: float) -> Controller:
    return SHIPPED.model_copy(update={"request": RequestLimits(**values)})


def test_without_a_table_nothing_is_changed() -> None:
    requests = np.random.default_rng(1).normal(size=50)
    assert np.array_equal(governed(SHIPPED, requests), requests)


def test_each_way_has_its_gradient() -> None:
    found = governed(limited(rise_nm_s=1000.0, fall_nm_s=2000.0), np.repeat([100.0, -100.0], 200))
    assert found[:100] == pytest.approx(np.arange(1, 101))
    assert found[200:300] == pytest.approx(100.0 - 2.0 * np.arange(1, 101))
    assert found[-1] == -100.0


def test_a_way_without_a_gradient_is_not_limited() -> None:
    found = governed(limited(rise_nm_s=1000.0), np.repeat([100.0, -100.0], 200))
    assert found[199] == pytest.approx(100.0)
    assert found[200] == -100.0


def test_around_zero_the_gradient_is_that_of_the_band() -> None:
    limits = limited(rise_nm_s=10_000.0, fall_nm_s=10_000.0, zero_band_nm=20.0, zero_gradient_nm_s=500.0)
    found = governed(limits, np.repeat([0.0, 100.0, -100.0], [1, 200, 200]))
    assert found[1:41] == pytest.approx(0.5 * np.arange(1, 41))  # to 20 N m in 40 ms
    assert found[41:49] == pytest.approx(20.0 + 10.0 * np.arange(1, 9))
    down = found[201:]
    assert down[:8] == pytest.approx(100.0 - 10.0 * np.arange(1, 9))
    assert down[8:88] == pytest.approx(20.0 - 0.5 * np.arange(1, 81))
    assert down[88:96] == pytest.approx(-20.0 - 10.0 * np.arange(1, 9))


def test_a_band_without_other_limits_stops_a_step_at_its_border() -> None:
    limits = limited(zero_band_nm=20.0, zero_gradient_nm_s=1000.0)
    found = governed(limits, np.repeat([100.0, -100.0], [25, 4]))
    assert found[:20] == pytest.approx(np.arange(1, 21))
    assert found[20:25] == pytest.approx(100.0)
    assert found[25:] == pytest.approx([20.0, 19.0, 18.0, 17.0])


def test_the_request_is_withdrawn_to_what_the_road_bears() -> None:
    """Beyond the slip the request is at most the observer's torque; then it comes back with its gradient."""
    controller = SHIPPED.model_copy(update={"slip": SlipWithdrawal(allowed=0.1, recovery_nm_s=1000.0)})
    memory = Memory()
    build(parameters_of(controller), memory)
    s, speed = memory.states, 10.0
    held = speed / controller.dfc.wheel_radius_m * controller.dfo.gear_ratio
    s[M.ROAD_LIMIT] = M.NO_LIMIT  # as a mode begins
    assert govern(memory.gains, s, 200.0, speed, held) == 200.0
    s[M.ESTIMATE] = 60.0
    assert govern(memory.gains, s, 200.0, speed, 1.11 * held) == 60.0
    assert govern(memory.gains, s, 200.0, speed, 1.09 * held) == pytest.approx(61.0)
    assert govern(memory.gains, s, -200.0, speed, 1.11 * held) == pytest.approx(-62.0)  # it drags no wheel
    for _ in range(138):
        assert govern(memory.gains, s, 200.0, speed, held) < 200.01
    assert govern(memory.gains, s, 200.0, speed, held) == 200.0
    assert govern(memory.gains, s, 500.0, speed, held) == 500.0  # what was withdrawn has come back


def test_wheels_slip_less_on_ice() -> None:
    def slip_of(controller: Controller) -> float:
        model = slippery_axle()
        _, _, asked = on_the_road(model, "phase_stabilization", 5.0)
        out = Axle(model, controller, initial_speed_m_s=10 / 3.6).play(asked)
        ahead = out["wheel_speed_rad_s"] - out["vehicle_speed_m_s"] / model.wheel_radius_m
        return float(ahead.max())

    withdrawn = SHIPPED.model_copy(update={"slip": SlipWithdrawal(allowed=0.1)})
    assert slip_of(withdrawn) < 0.8 * slip_of(SHIPPED)


def test_what_is_left_of_a_request_stands_in_the_rows() -> None:
    axle = Axle(slippery_axle(), limited(rise_nm_s=1000.0))
    axle.play(np.full(150, 100.0))
    followed = axle._loop.rows[-150:, T.FOLLOWED_REQUEST]
    assert followed == pytest.approx(np.minimum(np.arange(1, 151), 100.0))
