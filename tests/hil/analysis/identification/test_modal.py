from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from hil.analysis.identification import Modes, Structure
from hil.analysis.identification._modal import basis, basis_derivatives, polynomials

FREQUENCY = np.geomspace(0.1, 30, 20)


@st.composite
def structures(draw: st.DrawFn) -> Structure:
    integrator = draw(st.booleans())
    return Structure(
        integrator,
        draw(st.integers(1, 3)),
        draw(st.booleans()),
        tuple(draw(st.tuples(st.booleans(), st.booleans()))) if integrator else (False, False),
        draw(st.tuples(st.sampled_from([1, 2]), st.sampled_from([1, 2]))),
    )


@st.composite
def modes(draw: st.DrawFn) -> Modes:
    structure = draw(structures())
    rng = np.random.default_rng(draw(st.integers(0, 2**31)))
    omega = 2 * np.pi * rng.uniform(0.5, 30, structure.sections)
    damping = rng.uniform(0.02, 2, structure.sections)
    poles = np.stack([2 * damping * omega, omega**2], axis=1).ravel()
    if structure.real_pole:
        poles = np.append(poles, rng.uniform(1, 100))
    coefficients = np.empty((2, structure.order))
    for row in range(2):
        free = structure.free_coefficients(row)
        coefficients[row] = free @ rng.standard_normal(free.shape[1])
    return Modes(structure, poles, coefficients, rng.uniform(0, 0.02))


@given(modes())
@settings(max_examples=60, deadline=None)
def test_polynomials_are_the_same_function_and_stable(one: Modes) -> None:
    numerators, denominator = polynomials(one.structure, one.poles, one.coefficients)
    assert denominator[0] == 1
    assert np.all(one.pole_locations().real <= 0)
    s = 2j * np.pi * FREQUENCY
    for row, numerator in enumerate(numerators):
        ratio = np.polyval(numerator, s) / np.polyval(denominator, s) * np.exp(-one.delay_s * s)
        expected = one.response(FREQUENCY)[row]
        np.testing.assert_allclose(ratio, expected, rtol=1e-6, atol=1e-9 * np.max(np.abs(expected)))


@given(modes())
@settings(max_examples=60, deadline=None)
def test_structure_is_exact(one: Modes) -> None:
    numerators, denominator = polynomials(one.structure, one.poles, one.coefficients)
    if one.structure.integrator:
        assert denominator[-1] == 0.0
    for numerator, integrating, roll_off in zip(
        numerators, one.structure.integrating, one.structure.roll_off, strict=True
    ):
        if one.structure.integrator and not integrating:
            assert numerator[-1] == 0.0
        if roll_off == 2:
            assert numerator[0] == 0.0


@given(modes())
@settings(max_examples=30, deadline=None)
def test_derivatives_are_right(one: Modes) -> None:
    s = np.asarray(2j * np.pi * FREQUENCY, dtype=np.complex128)
    for number, (place, derivative) in enumerate(basis_derivatives(one.structure, one.poles, s)):
        step = 1e-6 * one.poles[number]
        upper, lower = one.poles.copy(), one.poles.copy()
        upper[number] += step
        lower[number] -= step
        difference = (basis(one.structure, upper, s) - basis(one.structure, lower, s)) / (2 * step)
        scale = np.max(np.abs(derivative), axis=0)
        np.testing.assert_allclose(difference[:, place] / scale, derivative / scale, atol=1e-5)
