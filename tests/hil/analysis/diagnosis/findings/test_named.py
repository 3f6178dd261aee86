"""What is named, as it is written."""

import numpy as np
import pytest

from hil.analysis.diagnosis.findings.named import clean
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse


def test_phases_lie_within_half_a_turn_and_what_was_not_fitted_is_left_out() -> None:
    ripple = EffectUse("motor_order_ripple", {"order": 8.0, "amplitude_nm": 1.0, "phase_rad": 7.0})
    assert clean(ripple).values["phase_rad"] == pytest.approx(7.0 - 2.0 * np.pi)
    friction = EffectUse("coulomb_friction", EFFECTS["coulomb_friction"].completed({"torque_nm": 2.0}))
    assert clean(friction).values == {"torque_nm": 2.0}
