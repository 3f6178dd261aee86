"""Scores of effects, and the columns that each may use."""

import pytest

from hil.analysis.diagnosis.fit._coordinates import Hypothesis
from hil.analysis.diagnosis.fit._fit import fit
from hil.analysis.diagnosis.search._probes import probes
from hil.analysis.diagnosis.search._screen import mismatch_columns, probe_columns, screen
from hil.core.channels import OUTPUTS
from hil.core.model import EffectUse
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
