"""Plants that the data allow, for designs that must hold for all of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.analysis.identification import fit_of, stated_errors, transfer_functions_of
from hil.core.channels import OUTPUTS
from hil.core.model import Model, TransferFunction

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

#: What is assumed of a model that says nothing of its uncertainty: standard deviations.
ASSUMED_GAIN = 0.03
ASSUMED_FREQUENCY = 0.02
ASSUMED_DELAY_S = 0.0003
DRAWS = 40


@dataclass(frozen=True)
class PlantSet:
    """Motor speed responses of possible plants.

    Attributes:
        responses: D x F; the first is the model itself.
        source: where the spread comes from, for people.
    """

    responses: ComplexArray
    source: str


def possible_plants(
    model: Model, motor: TransferFunction, frequency_hz: Array, *, draws: int = DRAWS, seed: int = 1
) -> PlantSet:
    """Draw plants from the fit's covariance, a chain's standard errors, or assumed tolerances.

    Assumed are 3 % of gain, 2 % of every pole and zero frequency (together) and 0.3 ms of dead time.

    Args:
        model: the model; when it was identified its `meta.fit` holds the covariance, or a chain's
            `meta.standard_errors` those of its parameters.
        motor: its motor speed function, dead time included.
        frequency_hz: F frequencies.
        draws: number of plants beside the model itself.
        seed: of the draws, so that a design can be repeated.
    """
    generator = np.random.default_rng(seed)
    nominal = motor.response(frequency_hz)
    fit = fit_of(model)
    if fit is not None and OUTPUTS[0] in fit.outputs:
        row = fit.outputs.index(OUTPUTS[0])
        drawn = [fit.sample(generator).response(frequency_hz)[row] for _ in range(draws)]
        return PlantSet(np.array([nominal, *drawn]), f"{draws} draws from the fit's covariance")
    errors = stated_errors(model)
    if errors:
        drawn = [_of_chain(model, errors, generator, frequency_hz) for _ in range(draws)]
        source = f"{draws} draws from the chain's standard errors, each taken by itself"
        return PlantSet(np.array([nominal, *drawn]), source)
    drawn = []
    for _ in range(draws):
        gain, stretch, late = generator.standard_normal(3)
        turn = np.exp(-2j * np.pi * frequency_hz * ASSUMED_DELAY_S * late)
        # G(f/x)/x keeps the integrator's low-frequency inertia while every pole and zero moves by x.
        x = 1 + ASSUMED_FREQUENCY * stretch
        moved = TransferFunction(motor.numerator, motor.denominator).response(frequency_hz / x) / x
        dead = np.exp(-2j * np.pi * frequency_hz * motor.delay_s)
        drawn.append((1 + ASSUMED_GAIN * gain) * moved * dead * turn)
    return PlantSet(
        np.array([nominal, *drawn]),
        f"{draws} draws from assumed tolerances: {ASSUMED_GAIN:.0%} gain, {ASSUMED_FREQUENCY:.0%} frequency, "
        f"{ASSUMED_DELAY_S * 1e3:g} ms dead time (the model carries no uncertainty)",
    )


def _of_chain(
    model: Model, errors: Mapping[str, float], generator: np.random.Generator, frequency_hz: Array
) -> ComplexArray:
    """Motor speed response of a chain drawn from standard errors; no parameter changes its sign."""
    moved = {
        name: max(value + error * generator.standard_normal(), 0.05 * value)
        for name, error in errors.items()
        for value in (model.parameters[name],)
    }
    functions, _ = transfer_functions_of(model.with_parameters(**moved))
    return functions[OUTPUTS[0]].response(frequency_hz)
