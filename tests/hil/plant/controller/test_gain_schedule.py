"""Gains over speed: linear between points, and what they do to the control."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.play_crossing import LEAD
from drivers import parameters_of
from hil.core.controller import Controller, load_controller
from hil.core.controller.shaping import Schedule
from hil.fmu import Axle
from hil.plant.closed_loop import tick as T
from hil.plant.controller import Memory, build
from hil.plant.controller import memory as M
from hil.plant.controller.gain_schedule import factor
from tests.hil.plant.test_effects import THREE

SHIPPED = load_controller(LEAD)


def scheduled(speeds: tuple[float, ...], wsc: tuple[float, ...], **more: tuple[float, ...]) -> Controller:
    table = Schedule(speed_m_s=speeds, wsc_factor=wsc, **more)
    return SHIPPED.model_copy(update={"schedule": table})


@pytest.mark.parametrize("points", range(1, 7))
def test_factors_are_interpolated_as_numpy_does(points: int) -> None:
    random = np.random.default_rng(points)
    speeds, wsc, dfc = np.cumsum(random.uniform(0.5, 9, points)), random.random(points), random.random(points)
    memory = Memory()
    controller = scheduled(tuple(speeds), tuple(wsc), dfc_factor=tuple(dfc))
    assert build(parameters_of(controller), memory) == 0
    for speed in (0.0, *speeds, *random.uniform(0, 60, 30), 200.0):
        assert factor(memory.gains, M.WSC_FACTOR, speed) == pytest.approx(np.interp(speed, speeds, wsc))
        assert factor(memory.gains, M.DFC_FACTOR, -speed) == pytest.approx(np.interp(speed, speeds, dfc))


def test_without_a_table_a_factor_is_one() -> None:
    memory = Memory()
    build(parameters_of(SHIPPED), memory)
    assert factor(memory.gains, M.WSC_FACTOR, 12.0) == 1.0


def test_a_constant_factor_is_that_of_the_gains() -> None:
    wsc = SHIPPED.wsc.model_copy(
        update={
            "proportional_gain": 0.5 * SHIPPED.wsc.proportional_gain,
            "integral_gain": 0.5 * SHIPPED.wsc.integral_gain,
        }
    )
    dfc = SHIPPED.dfc.model_copy(update={"integral_gain": 0.25 * SHIPPED.dfc.integral_gain})
    rows = []
    for controller in (
        scheduled((0.0, 50.0), (0.5, 0.5), dfc_factor=(0.25, 0.25)),
        SHIPPED.model_copy(update={"wsc": wsc, "dfc": dfc}),
    ):
        axle = Axle(THREE, controller, initial_speed_m_s=5.0)
        axle.play(np.repeat([0.0, 200.0, -50.0], 300))
        rows.append(axle._loop.rows[:, T.TORQUE_REF].copy())
    assert rows[0] == pytest.approx(rows[1], abs=1e-9)


def test_speeds_that_do_not_rise_are_refused_by_the_rmcu() -> None:
    good = parameters_of(scheduled((1.0, 2.0), (1.0, 0.5)))
    assert build({**good, "schedule_speed_1": 1.0}, Memory()) == 2  # OUT_OF_RANGE
    assert build({**good, "schedule_points": 7.0}, Memory()) == 2
