"""The road's friction, changed while the axle drives on it."""

from __future__ import annotations

import numpy as np
import pytest

from hil.core.effects import EFFECTS
from hil.core.model import EffectUse, Model
from hil.fmu import Axle
from hil.plant.closed_loop import tick as T
from tests.hil.plant.test_effects import THREE

PEAK, SLIDING = 3000.0, 2400.0


def axle_on(*more: EffectUse, **values: float) -> Axle:
    tyre = EFFECTS["tyre_friction"].check({"peak_nm": PEAK, "sliding_nm": SLIDING, **values}, "here")
    model = Model("three_inertia", THREE.parameters, (EffectUse("tyre_friction", tyre), *more))
    return Axle(model, initial_speed_m_s=5.0)


SEPARATE = EffectUse("separate_wheels", EFFECTS["separate_wheels"].check({}, "here"))


def loads(axle: Axle, torque_nm: float = 30.0, samples: int = 1500) -> np.ndarray:
    """What the tyres take, left and right, at the end of a torque of the motor."""
    axle.play(np.full(samples, torque_nm))
    return axle._loop.rows[-1, [T.LOAD_LEFT, T.LOAD_RIGHT]]


def test_a_road_that_becomes_ice_holds_its_share_and_no_more() -> None:
    axle = axle_on()
    before = loads(axle)
    axle._loop.plant.set_vehicle(friction_left=0.05, friction_right=0.05)
    on_ice = loads(axle)
    assert before.sum() > 230.0
    assert on_ice.sum() == pytest.approx(0.05 * SLIDING, rel=0.01)
    axle._loop.plant.set_vehicle(friction_left=1.0, friction_right=1.0)
    assert loads(axle).sum() > 230.0


def test_set_is_as_if_the_model_had_it() -> None:
    torque = np.full(800, 30.0)
    own, given = axle_on(road_friction=0.07), axle_on()
    given._loop.plant.set_vehicle(friction_left=0.07, friction_right=0.07)
    for axle in (own, given):
        axle.play(torque)
    assert np.array_equal(own._loop.rows[-800:], given._loop.rows[-800:])


def test_lumped_sides_have_the_mean_and_separate_ones_each_their_own() -> None:
    lumped, sides = axle_on(), axle_on(SEPARATE)
    for axle in (lumped, sides):
        axle._loop.plant.set_vehicle(friction_left=0.05)
    assert loads(lumped).sum() > 230.0  # (0.05 + 1) / 2 of it bears that
    left, _ = loads(sides)
    assert left == pytest.approx(0.05 * SLIDING / 2, rel=0.01)


def test_tyres_that_hold_everywhere_have_no_friction() -> None:
    assert axle_on()._loop.plant.has_friction
    assert not Axle(THREE)._loop.plant.has_friction
