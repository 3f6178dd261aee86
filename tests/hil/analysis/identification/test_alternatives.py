"""Orders and chains that were not taken, as models with what speaks for them."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hil.analysis.frequency_response import experiments_of
from hil.analysis.identification import (
    Identification,
    chain_models,
    fit_of,
    identify,
    information_criterion,
    order_models,
    resonances_of,
)
from tests.hil.analysis import paper_plant

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def found() -> Identification:
    return identify(experiments_of(paper_plant.recording(paper_plant.chirp(120.0)), to_hz=30.0))


def test_each_order_is_a_model_with_its_own_fit(found: Identification) -> None:
    models = order_models(found)
    assert len(models) == len(found.orders.candidates)
    for candidate, one in zip(found.orders.candidates, models, strict=True):
        if one is None:
            continue
        stored = fit_of(one.model)
        assert stored is not None
        assert len(stored.polynomials()[1]) == candidate.order + 1
        at = np.array([3.0])
        response = one.model.transfer_functions["motor_speed_rad_s"].response(at)
        assert response == pytest.approx(candidate.fit.modes.response(at)[0])


def test_a_low_order_is_doubtful_and_the_criterion_is_against_it(found: Identification) -> None:
    models = order_models(found)
    low = next(n for n, c in enumerate(found.orders.candidates) if c.order == 3)
    assert models[low] is None or models[low].judgement.verdict == "doubtful"  # type: ignore[union-attr]
    criteria = [information_criterion(c.fit) for c in found.orders.candidates]
    assert criteria[low] > criteria[found.orders.chosen] + 10


def test_chains_that_were_not_taken_say_so(found: Identification) -> None:
    models = chain_models(found)
    assert [model.kind for model in models] == ["rigid", "two_inertia", "three_inertia"]
    assert models[2] is found.physical
    assert "was fitted too" in str(models[0].meta["reason"])
    assert models[0].meta["explains_the_data"] is False


def test_errors_of_the_resonance_are_those_of_draws(found: Identification) -> None:
    nearest = min(resonances_of(found.fit), key=lambda one: abs(one.frequency_hz - 11))
    generator = np.random.default_rng(1)
    drawn = [found.fit.sample(generator).pole_locations() for _ in range(400)]
    poles = [min(one, key=lambda p: abs(p.imag - 2 * np.pi * nearest.frequency_hz)) for one in drawn]
    frequencies = [abs(pole) / (2 * np.pi) for pole in poles]
    assert nearest.frequency_hz == pytest.approx(np.mean(frequencies), rel=1e-3)
    assert nearest.frequency_error_hz == pytest.approx(np.std(frequencies), rel=0.15)
    assert nearest.damping_error == pytest.approx(np.std([-p.real / abs(p) for p in poles]), rel=0.15)


def test_a_pole_that_data_say_nothing_of_has_a_large_error_and_no_traceback(found: Identification) -> None:
    wide = dataclasses.replace(found.fit, covariance=1e8 * found.fit.covariance)
    assert all(np.isfinite(one.frequency_error_hz) for one in resonances_of(wide))


def test_the_criterion_is_schwarz_for_known_noise(found: Identification) -> None:
    fit = found.fit
    total = 2 * float(np.sum(np.abs(fit.residual) ** 2))
    count = 2 * fit.residual.size
    expected = total + len(fit.covariance) * np.log(count)
    assert information_criterion(fit) == pytest.approx(expected, rel=0.02)
