"""What stays as a torque over speed or angle: the curve of what has no name."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hil.analysis.missing_effects._curve import curves_of
from hil.analysis.missing_effects._hypothesis import Hypothesis
from hil.analysis.missing_effects._outcome import Replay
from hil.analysis.missing_effects._series import series_of
from hil.core.channels import OUTPUTS
from hil.core.model import EffectUse, Model
from hil.core.recording import Recording
from hil.plant import simulate
from tests.hil.analysis.missing_effects.chain import NUMBERS
from tests.hil.analysis.missing_effects.turning_mass import base, recording


def test_gravity_that_no_effect_stands_for_shows_as_a_sine_of_the_angle() -> None:
    model = base(0.54, 1.0)
    replays = [Replay(one) for one in series_of(model, [recording(0.54, 1.0, 0.0, 4.0, torque_nm=6.0)])]
    curve = curves_of(Hypothesis(model, model.parameters), replays)[0]
    assert curve.over.startswith("angle")
    assert curve.share > 0.9
    assert curve.torque_nm == pytest.approx(4.0 * np.sin(curve.at), abs=0.6)


def test_dry_friction_shows_over_speed_and_is_gone_with_its_effect() -> None:
    model = base(0.54, 2.17)
    replays = [Replay(one) for one in series_of(model, [recording(0.54, 2.17, 1.39)])]
    alone = Hypothesis(model, model.parameters)
    curve = curves_of(alone, replays)[0]
    assert curve.over.startswith("speed")
    fast = np.abs(curve.at) > 1.0
    assert curve.torque_nm[fast] == pytest.approx(1.39 * np.sign(curve.at[fast]), abs=0.15)
    named = alone.with_term(EffectUse("coulomb_friction", {"torque_nm": 1.39}))
    left, _, friction = curves_of(named, replays)
    assert np.max(np.abs(left.torque_nm[np.abs(left.at) > 1.0])) < 0.15
    assert (friction.effect, left.effect) == ("coulomb_friction", "")
    assert friction.law_nm is not None
    fast = np.abs(friction.at) > 1.0
    assert friction.law_nm[fast] == pytest.approx(
        1.39 * np.sign(friction.at[fast]), abs=0.12
    )  # windows that turn round
    assert friction.torque_nm[fast] == pytest.approx(friction.law_nm[fast], abs=0.15)


@pytest.mark.parametrize("effect", ["viscous_drag", "backlash"])
def test_of_an_axle_a_loss_shows_over_speed_and_a_play_over_twist(effect: str) -> None:
    """By the model that made the recording: measured and law are one but for noise."""
    sizes: dict[str, dict[str, float | str]] = {
        "viscous_drag": {"coefficient_nms_rad": 0.05},
        "backlash": {"half_gap_rad": 0.02},
    }
    model = Model("two_inertia", NUMBERS)
    hypothesis = Hypothesis(model, model.parameters).with_term(EffectUse(effect, sizes[effect]))
    time = np.arange(8000, dtype=np.float64) * 1e-3
    torque = 20.0 * np.sin(2.0 * np.pi * (0.5 * time + 0.2 * time**2))
    shown = simulate(hypothesis.model(), torque, 1e-3)
    channels = {name: shown[name] for name in OUTPUTS} | {"time_s": time, "motor_torque_ref_nm": torque}
    (series,) = series_of(model, [Recording(channels, Path("axle.csv"))])
    (curve,) = curves_of(hypothesis, [Replay(series)])
    assert curve.effect == effect
    assert curve.law_nm is not None
    assert curve.over == ("twist in rad" if effect == "backlash" else "speed in rad/s")
    assert np.ptp(curve.law_nm) > 0.0
    assert curve.torque_nm == pytest.approx(curve.law_nm, abs=0.03 * float(np.ptp(curve.law_nm)))
    if effect == "backlash":
        assert np.max(np.abs(curve.law_nm[np.abs(curve.at) < 0.01])) < 0.02 * np.ptp(curve.law_nm)
