"""How sure a name is, from what was tried beside it."""

from dataclasses import replace

import numpy as np
import pytest

from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.search.search import Found, search
from hil.analysis.diagnosis.tell.confidence import (
    _experiment,
    alternatives_of,
    confidence_of,
    drop_of,
    rivals,
    turns_one_way,
)
from hil.core.channels import OUTPUTS
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse
from tests.hil.analysis.diagnosis.one_recording import MODEL, one_problem

OFFSET = EffectUse("sensor_offset", {"channel": OUTPUTS[2], "offset": 20.0})


@pytest.fixture(scope="module")
def found() -> Found:
    return search(one_problem(OFFSET), Hypothesis(MODEL), lambda text: None)


def test_a_name_without_rivals_is_sure(found: Found) -> None:
    assert all(margin > 100.0 for _, margin in rivals(found, 0))
    assert confidence_of(found, 0) > 0.9
    assert drop_of(found, 0) == pytest.approx(found.base.total - found.best.total)


def test_nothing_is_an_alternative_to_nothing(found: Found) -> None:
    assert alternatives_of(found, "none") == ()


@pytest.mark.parametrize(("speeds", "one_way"), [((5.0, 200.0), True), ((-200.0, 200.0), False)])
def test_that_one_way_hides_friction_is_said_of_one_way_alone(
    speeds: tuple[float, float], one_way: bool
) -> None:
    problem = one_problem()
    measured = problem.traces[0].measured.copy()
    measured[:, 0] = np.linspace(*speeds, len(measured))
    problem = replace(problem, traces=(replace(problem.traces[0], measured=measured),))
    assert turns_one_way(problem) == one_way
    assert ("always turns one way" in _experiment(EFFECTS["coulomb_friction"], problem)) == one_way
    assert "one way" not in _experiment(EFFECTS["backlash"], problem)


def test_recordings_of_either_way_are_not_one_way() -> None:
    problem = one_problem()
    trace = problem.traces[0]
    there, back = trace.measured.copy(), trace.measured.copy()
    there[:, 0], back[:, 0] = 100.0, -100.0
    both = replace(problem, traces=(replace(trace, measured=there), replace(trace, measured=back)))
    assert not turns_one_way(both)


def test_without_a_speed_nothing_is_known_of_its_sign() -> None:
    problem = one_problem()
    measured = problem.traces[0].measured.copy()
    measured[:, :2] = np.nan
    trace = replace(
        problem.traces[0], measured=measured, samples=np.full_like(problem.traces[0].samples, np.nan)
    )
    assert not turns_one_way(replace(problem, traces=(trace,)))
