"""Normal equations with initial values eliminated are those of all numbers together."""

from typing import Any

import numpy as np
import pytest

from hil.analysis.diagnosis.fit.normal import normal_equations, promised_gain, reduced, start_step


def test_eliminated_starts_give_the_same_step() -> None:
    rng = np.random.default_rng(3)
    shared, initial = rng.normal(size=(2, 50, 4)), rng.normal(size=(2, 50, 3))
    errors = rng.normal(size=(2, 50))
    normals = [normal_equations(*one) for one in zip(shared, initial, errors, strict=True)]
    matrix, gradient = reduced(normals)
    step: Any = np.linalg.solve(matrix, gradient)
    whole = np.zeros((100, 10))
    whole[:, :4] = shared.reshape(100, 4)
    whole[:50, 4:7], whole[50:, 7:] = initial
    together: Any = np.linalg.lstsq(whole, errors.ravel())[0]
    assert step == pytest.approx(together[:4])
    assert start_step(normals[1], step) == pytest.approx(together[7:])


def test_a_step_takes_off_what_it_promises() -> None:
    rng = np.random.default_rng(4)
    shared, initial = rng.normal(size=(2, 50, 4)), rng.normal(size=(2, 50, 3))
    errors = rng.normal(size=(2, 50))
    normals = [normal_equations(*one) for one in zip(shared, initial, errors, strict=True)]
    matrix, gradient = reduced(normals)
    step: Any = 0.7 * np.linalg.solve(matrix, gradient)  # a damped one
    left = [
        e - s @ step - i @ start_step(n, step)
        for e, s, i, n in zip(errors, shared, initial, normals, strict=True)
    ]
    gain = float(np.sum(errors**2) - np.sum(np.square(left)))
    assert promised_gain(normals, matrix, gradient, step) == pytest.approx(gain)
