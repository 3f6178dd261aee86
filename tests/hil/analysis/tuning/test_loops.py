"""Margins of the speed loop are those of the control design, and see linear effects."""

import pytest

from hil.analysis.control_design import DesignSpec, design
from hil.analysis.tuning import SpeedLoops, with_values
from hil.core.controller.shaping import Schedule
from hil.core.model import EffectUse
from tests.hil.analysis.tuning.test_parameters import PHASE
from tests.hil.analysis.tuning.trials import MODEL


def test_they_are_those_of_the_design():
    spec = DesignSpec(inertia_kg_m2=4.4625)
    designed = design(MODEL, spec)
    expected = designed.loop("phase").margins
    found = SpeedLoops([MODEL], 0.001).margins(designed.controller, 0)
    assert found.stable
    assert found.sensitivity_peak == pytest.approx(expected.sensitivity_peak, rel=2e-3)
    assert found.gain_margin_db == pytest.approx(expected.gain_margin_db, abs=0.05)
    assert found.phase_margin_deg == pytest.approx(expected.phase_margin_deg, abs=0.2)


def test_dead_time_of_an_effect_counts():
    late = MODEL.with_effects(*MODEL.effects, EffectUse("dead_time", {"extra_delay_s": 0.003}))
    loops = SpeedLoops([MODEL, late, MODEL.with_parameters(torque_delay=0.011)], 0.001)
    first, effect, parameter = (loops.margins(PHASE, number) for number in range(3))
    assert effect.sensitivity_peak == pytest.approx(parameter.sensitivity_peak, rel=1e-6)
    assert effect.sensitivity_peak > first.sensitivity_peak


def test_a_loop_that_is_too_fast_is_unstable():
    assert not SpeedLoops([MODEL], 0.001).margins(with_values(PHASE, {"pole_rad_s": 3.0}), 0).stable


def test_of_scheduled_gains_the_worst_counts():
    loops = SpeedLoops([MODEL], 0.001)

    def scheduled(*factors):
        speeds = tuple(float(place) for place in range(len(factors)))
        return PHASE.model_copy(update={"schedule": Schedule(speed_m_s=speeds, wsc_factor=factors)})

    wsc = PHASE.wsc
    gains = {"proportional_gain": 2 * wsc.proportional_gain, "integral_gain": 2 * wsc.integral_gain}
    twice = loops.margins(PHASE.model_copy(update={"wsc": wsc.model_copy(update=gains)}), 0)
    assert loops.margins(scheduled(0.5, 2.0, 1.0), 0) == twice
    assert twice.sensitivity_peak > loops.margins(PHASE, 0).sensitivity_peak
    assert loops.margins(scheduled(1.0, 0.0), 0) == loops.margins(PHASE, 0)
    assert not loops.margins(scheduled(1.0, 20.0, 0.5), 0).stable
