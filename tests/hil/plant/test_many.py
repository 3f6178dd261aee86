"""Many models at once: forces that are known before the motion is, and those that are not."""

from dataclasses import replace

import numpy as np
import pytest

from hil.core.model import EffectUse
from hil.plant import ideal_sensors, pack, simulate_many
from tests.hil.analysis.diagnosis.one_recording import MODEL

RIPPLE = EffectUse("wheel_order_disturbance", {"order": 3.0, "amplitude_nm": 8.0, "phase_rad": 0.4})
FRICTION = EffectUse("coulomb_friction", {"torque_nm": 0.4})
NEXT_TO_NOTHING = EffectUse("shaft_cubic_stiffness", {"coefficient_nm_rad3": 1e-9})


@pytest.mark.parametrize("others", [(), (FRICTION,)], ids=["alone", "with friction"])
def test_a_ripple_of_a_measured_angle_moves_the_axle_as_one_of_a_force_that_hangs_on_the_motion(
    others: tuple[EffectUse, ...],
) -> None:
    time = np.arange(8000) * 1e-3
    torque = 20.0 + 30.0 * np.sin(4.0 * time)
    angles = np.column_stack([2.0 * time**2, 16.0 * time**2])
    shown = []
    for more in ((), (NEXT_TO_NOTHING,)):
        model = replace(MODEL, effects=(RIPPLE, *others, *more))
        parameters, start = pack(model)[None], np.zeros((1, 3))
        shown.append(simulate_many(parameters, torque, 1e-3, start, ideal_sensors(1), 4, angles)[0])
    assert np.std(shown[0][:, 2]) > 10.0
    np.testing.assert_allclose(shown[0], shown[1], rtol=1e-9, atol=1e-9)
