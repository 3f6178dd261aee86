"""The plant as the RMCU may use it, and plants that the data allow, for designs that hold for all.

The RMCU's filters invert numerators, so those must be invertible.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from pydantic import ValidationError

from hil.analysis.identification import fit_of, stated_errors, transfer_functions_of
from hil.core.channels import OUTPUTS
from hil.core.controller import LARGEST_ORDER, Plant
from hil.core.errors import BadInputError
from hil.core.errors.mistakes import needed
from hil.core.model import Model, TransferFunction, refuse_without_vehicle
from hil.plant import refuse_too_stiff

Array = npt.NDArray[np.float64]

_LEAST_DAMPING = 0.02
_FAR_ZERO_HZ = 200.0


@dataclass(frozen=True)
class DesignPlant:
    """What a design starts from.

    Attributes:
        functions: the model's transfer functions, dead time included.
        filters: the same for the RMCU, every numerator that is inverted made invertible.
        delay_s: dead time.
        resonance_hz: frequency of the least damped pole pair.
        inertia_kg_m2: J_l/N² + J_m seen by the motor at low frequency.
        gear_ratio: motor speed over wheel speed at low frequency.
        notes: what was changed, and why.
    """

    functions: dict[str, TransferFunction]
    filters: Plant
    delay_s: float
    resonance_hz: float
    inertia_kg_m2: float
    gear_ratio: float
    notes: tuple[str, ...]


def design_plant(model: Model) -> DesignPlant:
    """Prepare a model of any kind for control design.

    Raises:
        BadInputError: an output is missing, the functions do not share one denominator, the order is
            beyond the RMCU's, the plant is unstable, too stiff or has no oscillating pole pair.
    """
    refuse_without_vehicle(model, "", "design")
    refuse_too_stiff(model)
    functions, notes = transfer_functions_of(model)
    missing = [name for name in OUTPUTS if name not in functions]
    if missing:
        raise BadInputError(
            f"the model has no '{missing[0]}'", fix="the controller needs all three outputs: record them all"
        )
    motor, wheel = functions[OUTPUTS[0]], functions[OUTPUTS[1]]
    denominator = np.array(motor.denominator) / motor.denominator[0]
    if len(denominator) > LARGEST_ORDER + 1:
        raise BadInputError(f"order {len(denominator) - 1} is beyond the RMCU's {LARGEST_ORDER}")
    numerators = [
        np.trim_zeros(np.array(functions[n].numerator) / functions[n].denominator[0], "f") for n in OUTPUTS
    ]
    _refuse_empty(denominator, numerators)
    poles = np.roots(denominator)
    if np.any(poles.real > 1e-6 * np.max(np.abs(poles))):
        raise BadInputError("the plant is unstable", fix="identify it again")
    changes = list(notes)
    numerators[1] = _invertible(numerators[1], len(numerators[0]) - 1, "wheel speed", "(17)", changes)
    numerators[2] = _invertible(numerators[2], len(denominator) - 1, "shaft torque", "(18)", changes)
    with usable():
        filters = Plant(
            denominator=tuple(float(c) for c in denominator),
            motor_speed=tuple(float(c) for c in numerators[0]),
            wheel_speed=tuple(float(c) for c in numerators[1]),
            shaft_torque=tuple(float(c) for c in numerators[2]),
        )
    return DesignPlant(
        functions,
        filters,
        motor.delay_s,
        resonance_hz(denominator),
        _low_frequency_inertia(motor),
        _ratio(motor, wheel),
        tuple(changes),
    )


@contextlib.contextmanager
def usable() -> Iterator[None]:
    """Say in words that numbers which follow from a model are none that a controller may have.

    Raises:
        BadInputError: names the number and its bounds.
    """
    try:
        yield
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"])
        raise BadInputError(
            f"the RMCU cannot use the controller for this model: {key} = {first['input']!r}: {needed(first)}",
            fix="check the units of the model's numbers",
        ) from error


def _refuse_empty(denominator: Array, numerators: list[Array]) -> None:
    for name, numerator in zip(OUTPUTS, numerators, strict=True):
        if not np.any(numerator):
            raise BadInputError(
                f"the numerator of '{name}' is zero: the output never moves", fix="identify the model again"
            )
        if not (np.all(np.isfinite(numerator)) and np.all(np.isfinite(denominator))):
            raise BadInputError(
                f"the coefficients of '{name}' are too far apart for floating point",
                fix="check their units: descending powers of s, SI",
            )


def resonance_hz(denominator: Array) -> float:
    """Natural frequency |p|/2π of the least damped complex pole pair.

    Raises:
        BadInputError: no pole pair oscillates.
    """
    poles = np.roots(denominator)
    oscillating = poles[poles.imag > 1e-9 * np.max(np.abs(poles))]
    if not oscillating.size:
        raise BadInputError(
            "the plant has no resonance", fix="a rigid model needs no phase stabilisation; use a larger chain"
        )
    damping = -oscillating.real / np.abs(oscillating)
    return float(np.abs(oscillating[np.argmin(damping)]) / (2 * np.pi))


def _invertible(numerator: Array, dividend: int, name: str, equation: str, notes: list[str]) -> Array:
    """A numerator that can stand in a stable, proper filter; `dividend` is the order above it.

    Zeros in the right half plane are mirrored into the left: the gain stays as it is at every
    frequency, the phase of the inverse is then not exact. Zeros near the imaginary axis get a damping
    ratio of 0.02, or the filter would ring. Missing order is made up by real zeros far above the band.
    """
    origin = len(numerator) - len(np.trim_zeros(numerator, "b"))
    zeros = np.roots(numerator[: len(numerator) - origin])
    moved = zeros.copy()
    right = zeros.real > 0
    moved[right] = -zeros[right].conj()
    if right.any():
        places = ", ".join(f"{abs(z) / (2 * np.pi):.3g} Hz" for z in zeros[right & (zeros.imag >= 0)])
        notes.append(
            f"{name} has zeros in the right half plane ({places}): an inverse would be unstable, so they are "
            f"mirrored in the filter {equation}; its gain is exact, its phase is not"
        )
    damping = -moved.real / np.maximum(np.abs(moved), 1e-300)
    ringing = damping < _LEAST_DAMPING
    moved[ringing] = np.abs(moved[ringing]) * (
        -_LEAST_DAMPING + 1j * np.sign(moved[ringing].imag) * np.sqrt(1 - _LEAST_DAMPING**2)
    )
    if ringing.any():
        notes.append(
            f"zeros of {name} with hardly any damping get a damping ratio of {_LEAST_DAMPING:g} "
            f"in the filter {equation}"
        )
    if right.any() or ringing.any():
        numerator = np.append(abs(numerator[0]) * np.real(np.poly(moved)), np.zeros(origin))
    lacking = dividend - 1 - (len(numerator) - 1)
    for _ in range(max(lacking, 0)):
        numerator = np.convolve(numerator, [1 / (2 * np.pi * _FAR_ZERO_HZ), 1.0])
    if lacking > 0:
        notes.append(
            f"the filter {equation} would be improper: {lacking} zeros at {_FAR_ZERO_HZ:g} Hz "
            f"are added to {name}"
        )
    return numerator


def _low_frequency_inertia(motor: TransferFunction) -> float:
    """1/(s·G(s)) as s → 0 for an integrating plant; with drag, from the highest coefficients that count.

    With a real pole p near the origin in place of the integrator, G ≈ 1/(J (s - p)) there.
    """
    denominator = np.array(motor.denominator)
    if denominator[-1] == 0:
        slope = float(denominator[-2])
    else:
        poles = np.roots(denominator)
        slope = float(denominator[-1] / -poles[np.argmin(np.abs(poles))].real)
    return _positive(slope, motor.numerator[-1], "inertia seen by the motor")


def _ratio(motor: TransferFunction, wheel: TransferFunction) -> float:
    scale = wheel.denominator[0] / motor.denominator[0]
    return _positive(motor.numerator[-1] * scale, wheel.numerator[-1], "gear ratio")


def _positive(top: float, bottom: float, name: str) -> float:
    """top/bottom, which must be a positive number."""
    value = top / bottom if bottom else 0.0
    if not (np.isfinite(value) and value > 0):
        raise BadInputError(
            f"the model has no positive {name} at low frequency",
            fix="identify it from data that reach lower frequencies",
        )
    return float(value)


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
