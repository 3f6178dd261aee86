"""How packed models begin: numbers that a kind has no state for count for nothing."""

from __future__ import annotations

import numpy as np
import pytest

from hil.core.model import EffectUse, Model
from hil.plant import begins_of, ideal_sensors, pack, simulate_many, turns

_NUMBERS = {
    "rigid": {"motor_inertia": 0.02, "gear_ratio": 8.0, "vehicle_inertia": 100.0, "viscous_drag": 0.1},
    "two_inertia": {
        "motor_inertia": 0.02,
        "gear_ratio": 8.0,
        "shaft_stiffness": 6000.0,
        "shaft_damping": 20.0,
        "vehicle_inertia": 100.0,
    },
}
_START = np.array([[40.0, 5.1, 30.0, 0.2, 0.01]])


@pytest.mark.parametrize(("kind", "has"), [("rigid", 1), ("two_inertia", 3)])
def test_a_start_without_what_a_kind_does_not_have_shows_the_same(kind: str, has: int) -> None:
    slots = pack(Model(kind, {**_NUMBERS[kind], "torque_delay": 0.0}))[None]
    begins = begins_of(slots, _START)
    assert np.count_nonzero(begins) == has
    torque = 10.0 * np.sin(0.02 * np.arange(400))
    whole, less = (simulate_many(slots, torque, 1e-3, one, ideal_sensors(1)) for one in (_START, begins))
    assert np.array_equal(whole, less)


def test_only_ripples_follow_an_angle() -> None:
    numbers = {**_NUMBERS["two_inertia"], "torque_delay": 0.0}
    ripple = EffectUse("motor_order_ripple", {"order": 2.0, "amplitude_nm": 1.0, "phase_rad": 0.0})
    friction = EffectUse("coulomb_friction", {"torque_nm": 1.0})
    uses: tuple[tuple[EffectUse, ...], ...] = ((), (friction,), (ripple, friction))
    slots = np.stack([pack(Model("two_inertia", numbers, some)) for some in uses])
    assert turns(slots).tolist() == [False, False, True]
