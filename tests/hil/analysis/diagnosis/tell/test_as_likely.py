"""Models that the recordings allow as well: they scatter as the standard errors say."""

import numpy as np
import pytest

from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.covariance import standard_errors
from hil.analysis.diagnosis.search.search import search
from hil.analysis.diagnosis.tell.apart import as_likely
from hil.analysis.diagnosis.tell.consequences import consequences
from tests.hil.analysis.diagnosis.one_recording import MODEL, one_problem


def test_drawn_models_scatter_as_the_fit_is_known() -> None:
    problem = one_problem()
    kept = search(problem, Hypothesis(MODEL), lambda text: None).best
    known = standard_errors(problem, kept)
    drawn = as_likely(kept, known)
    given = kept.hypothesis.model(kept.theta).parameters
    errors = dict(zip((c.name for c in kept.hypothesis.coordinates()), known, strict=True))
    for name in ("shaft_stiffness", "vehicle_inertia"):
        scatter = np.std([np.log(one.parameters[name] / given[name]) for one in drawn], ddof=1)
        assert scatter == pytest.approx(errors[name], rel=0.35), name
    again = as_likely(kept, known)
    assert [one.parameters for one in again] == [one.parameters for one in drawn]


def test_a_figure_is_known_as_well_as_what_it_depends_on() -> None:
    damping = MODEL.parameters["shaft_damping"]
    alike = [MODEL.with_parameters(shaft_damping=damping * (1.0 + step)) for step in (-0.02, 0.02)]
    told = consequences(MODEL, MODEL, alike)["overshoot_shaft_torque_percent"]
    less, more = (consequences(MODEL, one)["overshoot_shaft_torque_percent"]["after"] for one in alike)
    assert told["after_standard_error"] == pytest.approx(abs(less - more) / np.sqrt(2.0))
    assert "after_standard_error" not in consequences(MODEL, MODEL)["overshoot_shaft_torque_percent"]
