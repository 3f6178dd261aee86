from __future__ import annotations

import numpy as np
import pytest

from hil.analysis.identification import Identification, chain_response, choose_order
from tests.hil.analysis.conftest import GRID, exact, outputs_of
from tests.hil.analysis.identification.chains import THREE, TWO


def test_paper_needs_order_five(paper_identification: Identification) -> None:
    orders = paper_identification.orders
    assert orders.best.order == 5
    assert orders.best.integrator
    by_order = {c.order: c for c in orders.candidates if c.integrator}
    assert by_order[4].held_out > 100 * by_order[5].held_out
    assert by_order[5].whiteness > 0.01 > by_order[4].whiteness


@pytest.mark.slow
def test_two_inertias_need_order_three() -> None:
    choice = choose_order(exact(chain_response("two_inertia", TWO, GRID), 0.01), (2, 3, 4, 5))
    assert choice.best.order == 3


def test_drag_moves_the_pole_from_the_origin() -> None:
    """A rigid axle with drag has one slow pole and no integrator."""
    values = {
        "motor_inertia": 0.5,
        "gear_ratio": 8.0,
        "vehicle_inertia": 100.0,
        "viscous_drag": 3.0,
        "torque_delay": 0.005,
    }
    speeds = outputs_of(exact(chain_response("rigid", values, GRID), 0.005), 2)
    choice = choose_order(speeds, (2, 3))
    assert not choice.best.integrator
    poles = choice.best.fit.modes.pole_locations()
    assert np.min(np.abs(poles + 3.0 / (0.5 + 100 / 64))) < 0.05


def test_noise_free_data_do_not_ask_for_the_highest_order() -> None:
    assert choose_order(exact(chain_response("three_inertia", THREE, GRID)), (4, 5, 6)).best.order == 5
