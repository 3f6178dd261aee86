"""A number that stays is worth all of it; one that fades over each recording what is always there."""

from __future__ import annotations

import numpy as np
import pytest

from hil.analysis.missing_effects._fit import fit, linearised, point_at
from hil.analysis.missing_effects._hypothesis import Hypothesis
from hil.analysis.missing_effects._noise import proven_noise
from hil.analysis.missing_effects._problem import problem_of
from hil.analysis.missing_effects._series import series_of
from hil.analysis.missing_effects._share import constancy
from hil.core.channels import INPUT
from hil.core.model import EffectUse
from hil.core.recording import Recording
from tests.hil.analysis.missing_effects.turning_mass import base, recording

_COST = 10.0  # nats


def _worth(first: float, last: float) -> float:
    """Constancy of a gain that goes from `first` to `last` over the recording."""
    acted = recording(0.5, 0.3)
    gain = np.linspace(first, last, len(acted.time_s))
    asked = Recording({**acted.channels, INPUT: acted[INPUT] / gain}, acted.source)
    model = base(0.5, 0.3)
    series = series_of(model, [asked])
    noise = proven_noise(series, {})
    problem = problem_of(model, series, noise)
    begin = Hypothesis(model, dict(model.parameters)).with_term(EffectUse("torque_gain", {"gain": 1.1}))
    point = fit(problem, point_at(problem, begin))
    own = problem.weighed_by(point.powers(problem).spectrum(noise))
    return constancy(own, linearised(own, fit(own, point)), 0, _COST)


def test_a_gain_that_stays_is_worth_all_of_it() -> None:
    assert _worth(1.2, 1.2) == 1.0


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_gain_that_grows_from_nothing_is_worth_nothing(sign: float) -> None:
    assert _worth(1.0, 1.0 + 0.2 * sign) < 0.2


def test_a_gain_that_warms_off_by_a_tenth_keeps_most_of_its_worth() -> None:
    assert 0.85 < _worth(1.21, 1.19) < 1.0
