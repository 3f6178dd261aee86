"""Scores of effects, and the columns that each may use."""

from pathlib import Path

import numpy as np
import pytest

from hil.analysis.diagnosis.data.noise import noise_levels
from hil.analysis.diagnosis.data.trace import trace_of
from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.fit import fit
from hil.analysis.diagnosis.fit.problem import problem_of
from hil.analysis.diagnosis.search.probes import probes
from hil.analysis.diagnosis.search.screen import _near, _scored, mismatch_columns, probe_columns, screen
from hil.core.channels import INPUT, OUTPUTS, TIME
from hil.core.model import EffectUse, Model
from hil.core.recording import Recording
from hil.plant import simulate
from tests.hil.analysis.diagnosis.one_recording import MODEL, one_problem

OFFSET = EffectUse("sensor_offset", {"channel": OUTPUTS[2], "offset": 20.0})


def test_a_hidden_offset_scores_most_at_its_size() -> None:
    problem = one_problem(OFFSET)
    base = fit(problem, Hypothesis(MODEL), rounds=1)
    best = screen(problem, base)[0]
    assert best.key == ("sensor_offset", OUTPUTS[2])
    assert best.use.values["offset"] == pytest.approx(20.0, rel=0.1)
    assert best.gain == pytest.approx(base.total - problem.rows, rel=0.3)


def test_every_probe_has_columns_of_its_own() -> None:
    problem = one_problem()
    candidates = probes(problem, fit(problem, Hypothesis(MODEL), rounds=0))
    own = [columns[5:].tolist() for _, columns in probe_columns(candidates, 5)]
    assert [len(c) for c in own] == [len(p.directions) for p in candidates]
    assert [c for columns in own for c in columns] == list(range(5, 5 + sum(map(len, own))))


def test_a_wrong_parameter_frees_its_own_column() -> None:
    hypothesis = Hypothesis(MODEL)
    names = [c.name for c in hypothesis.coordinates()]
    freed = {use.values["parameter"]: names[index] for use, index in mismatch_columns(hypothesis)}
    assert freed == {name: name for name in names if name != "torque_delay"}


def test_an_effect_of_many_sizes_is_looked_at_closely_where_it_promises_something() -> None:
    mount = EffectUse(
        "mount_mode",
        {"housing_inertia_kg_m2": 4.0, "mount_stiffness_nm_rad": 1.6e4, "mount_damping_nms_rad": 180.0},
    )
    for hidden, closely in ((mount, True), (OFFSET, False)):
        problem = one_problem(hidden)
        base = fit(problem, Hypothesis(MODEL), rounds=1)
        every = probes(problem, base)
        first = _scored(problem, base, [c for c in every if c.probe.first], None)
        found = {score.key: score for score in screen(problem, base)}
        best = _scored(problem, base, [c for c in every if c.id == "mount_mode"], None)["mount_mode", ""]
        assert bool([c for c in _near(first, every) if c.id == "mount_mode"]) is closely
        if closely:
            assert found["mount_mode", ""].gain == pytest.approx(best.gain, rel=0.02)
            assert best.gain > first["mount_mode", ""].gain


def test_a_dead_time_at_the_edge_of_a_sample_promises_nothing_of_what_a_lag_explains() -> None:
    """A rigid axle's dead time acts by whole samples: half of a jump cannot be had."""
    inertias = {"motor_inertia": 0.02, "gear_ratio": 10.0, "vehicle_inertia": 300.0}
    rigid = Model("rigid", {**inertias, "viscous_drag": 0.002, "torque_delay": 0.0079995})
    lag = EffectUse("actuator_lag", {"time_constant_s": 0.0017})
    rng = np.random.default_rng(5)
    time = np.arange(0.0, 8.0, 1e-3)
    torque = 20.0 * np.sin(2 * np.pi * (0.2 * time + 1.5 * time**2))
    shown = simulate(rigid.with_effects(lag), torque, 1e-3)
    channels = {TIME: time, INPUT: torque}
    for name, noise in zip(OUTPUTS, (0.05, 0.005, 0.3), strict=True):
        channels[name] = shown[name] + rng.normal(0.0, noise, len(time))
    traces = [trace_of(Recording(channels, Path("edge.csv")))]
    problem = problem_of(traces, noise_levels(traces), 10.0)
    without = fit(problem, Hypothesis(rigid, far=True), rounds=0)
    scores = {score.key: score.gain for score in screen(problem, without)}
    assert scores["actuator_lag", ""] > 0.7 * (without.total - problem.rows)
