"""Plants that the data allow, for designs that must hold for all of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.analysis.identification import fit_of
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
    """Draw plants from the fit's covariance, or from assumed tolerances where the model has none.

    Assumed are 3 % of gain, 2 % of every pole and zero frequency (together) and 0.3 ms of dead time.

    Args:
        model: the model; its `meta.fit` holds the covariance when it was identified.
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
