"""A model that the integrator cannot carry is refused where it comes in."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hil.core.errors import BadInputError
from hil.core.model import Model, load_model
from hil.plant import LONGEST_STEP_S, is_stable, refuse_too_stiff, simulate
from tests.benches_for_tests import SIM


def shipped(**changes: float) -> Model:
    assert SIM.simulation is not None
    return load_model(SIM.simulation.model).with_parameters(**changes)


def test_the_shipped_model_is_carried() -> None:
    refuse_too_stiff(shipped())


@pytest.mark.parametrize(
    "changes",
    [{"shaft_stiffness": 1e9, "wheel_inertia": 0.01}, {"shaft_damping": 1e6}, {"motor_inertia": 1e-7}],
)
def test_a_model_too_stiff_is_refused_by_its_file(changes: dict[str, float]) -> None:
    with pytest.raises(
        BadInputError, match=r"fastest motion, .* Hz, is too fast for the integrator"
    ) as caught:
        refuse_too_stiff(shipped(**changes))
    assert caught.value.where.endswith("three_inertia.toml")


def test_the_border_is_where_the_steps_let_it_grow() -> None:
    """Held against the integrator itself: the last model that is taken stays, the first refused one grows."""
    inertias = np.geomspace(1e-6, 1e-2, 60)
    taken = [is_stable(shipped(motor_inertia=float(inertia))) for inertia in inertias]
    border = taken.index(True)
    assert 0 < border < len(taken)
    assert all(taken[border:])
    for place, grows in ((border - 2, True), (border + 1, False)):
        model = shipped(motor_inertia=float(inertias[place])).with_effects()
        speed = simulate(model, np.ones(600), 1e-3)["motor_speed_rad_s"]
        assert (not np.all(np.abs(speed) < 1e6)) == grows


def test_coarser_steps_carry_less() -> None:
    model = shipped(motor_inertia=2e-5)
    assert is_stable(model, LONGEST_STEP_S)
    assert not is_stable(model, 20 * LONGEST_STEP_S)


def test_a_model_of_functions_needs_no_steps(tmp_path: Path) -> None:
    (tmp_path / "m.toml").write_text(
        'kind = "transfer_function"\n[transfer_functions.motor_speed_rad_s]\nnumerator = [1.0]\n'
        "denominator = [1e-9, 1.0]\n"
    )
    assert is_stable(load_model(tmp_path / "m.toml"))
