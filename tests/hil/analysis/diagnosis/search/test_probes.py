"""Sizes at which effects are tried first."""

import numpy as np
import pytest

from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.fit import fit
from hil.analysis.diagnosis.search.probes import Recorded, mismatches, probes
from hil.core.channels import OUTPUTS
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse, Model
from tests.hil.analysis.diagnosis.one_recording import MODEL, one_problem

GAIN = EffectUse("sensor_gain", {"channel": OUTPUTS[2], "gain": 1.2})


def test_every_probe_is_an_effect_that_may_be_added() -> None:
    problem = one_problem()
    one = fit(problem, Hypothesis(MODEL, (GAIN,)), rounds=0)
    for probe in probes(problem, one):
        use = probe.use([1.0] * len(probe.directions))
        assert MODEL.kind in EFFECTS[use.id].needs
        assert (use.id, use.values.get("channel", "")) != ("sensor_gain", OUTPUTS[2])
        packed, _ = one.hypothesis.with_term(use).packed(one.hypothesis.with_term(use).start())
        assert np.isfinite(packed[:3]).all()


def test_every_parameter_may_be_wrong_but_dead_time() -> None:
    found = {use.values["parameter"] for use in mismatches(Hypothesis(MODEL))}
    assert found == set(MODEL.parameters) - {"torque_delay"}


def test_a_scene_knows_the_largest_torques() -> None:
    problem = one_problem()
    scene = Recorded(problem, fit(problem, Hypothesis(MODEL), rounds=0))
    assert scene.torque_nm == np.max(np.abs(problem.traces[0].torque))
    assert scene.shaft_torque_nm == np.max(np.abs(problem.traces[0].measured[:, 2]))
    assert scene.parameters["gear_ratio"] > 1.0
    assert scene.channels == OUTPUTS


def test_values_that_a_probe_leaves_out_are_the_defaults() -> None:
    problem = one_problem()
    found = [p for p in probes(problem, fit(problem, Hypothesis(MODEL), rounds=0)) if p.id == "backlash"]
    used = [p.use([1.0] * len(p.directions)).values for p in found]
    assert {values["depth_damping_nms_rad2"] for values in used} == {0.0}
    plain = [values for values in used if values["contact_depth_rad"] == 0.0]
    assert {values["contact_damping_nms_rad"] for values in plain} == {0.0}
    assert len(plain) < len(used)  # flanks that damp are tried as well


def test_effects_on_top_of_an_added_third_inertia_have_its_tyre() -> None:
    two = Model(
        "two_inertia", {n: v for n, v in MODEL.parameters.items() if "tyre" not in n and n != "wheel_inertia"}
    )
    tyre = EffectUse(
        "tyre_compliance", {"wheel_inertia": 4.0, "tyre_stiffness": 5000.0, "tyre_damping": 300.0}
    )
    problem = one_problem()
    one = fit(problem, Hypothesis(two, (tyre,)), rounds=0)
    assert {"tyre_slip", "dyno_lag"} <= {probe.id for probe in probes(problem, one)}
    assert Recorded(problem, one).parameters["tyre_stiffness"] == pytest.approx(5000.0)
