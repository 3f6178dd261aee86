"""Which driveline chain explains a measured response: rigid, two inertias or three."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.analysis.frequency_response import FrequencyResponse
from hil.analysis.identification._chain import CHAINS, chain_response
from hil.core.channels import OUTPUTS
from hil.core.errors import BadInputError
from hil.core.errors.wording import share
from hil.core.model import Model, parameter_names

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

#: A chain explains an output when its rms misfit beyond the noise is within these.
TOLERANCE_DB = 1.5
TOLERANCE_DEG = 10.0
#: Rms of the logarithm (0.17 dB and 1.1 degrees) beyond noise, above which parameters are off by more than
#: their standard errors say: a motor speed that is 1 ms late makes as much.
TRUSTED_EXCESS = 0.02
_HALVED = 0.5
_FAR = 0.3
_NOTICEABLE = 0.01  # rms of the logarithm: 0.09 dB and 0.6 degrees
_USUAL_MODEL_ERROR = 0.03  # relative; data less sure than this count less
_SMALLEST = {"shaft_damping": 1e-3, "tyre_damping": 1e-3, "viscous_drag": 1e-6, "torque_delay": 1e-5}
_LARGEST = {"torque_delay": 0.9, "gear_ratio": 1e3}


@dataclass(frozen=True)
class Misfit:
    """Root mean square over frequency of model against measurement, and what noise alone would give."""

    gain_db: float
    phase_deg: float
    noise_db: float
    noise_deg: float

    @property
    def explained(self) -> bool:
        """Whether it is within the tolerance beyond the noise."""
        beyond_db = np.sqrt(max(self.gain_db**2 - self.noise_db**2, 0.0))
        beyond_deg = np.sqrt(max(self.phase_deg**2 - self.noise_deg**2, 0.0))
        return bool(beyond_db <= TOLERANCE_DB and beyond_deg <= TOLERANCE_DEG)


def size_of(misfit: Mapping[str, Misfit]) -> float:
    """Rms of the logarithmic misfit over all outputs, noise taken off (1 = a factor e or 57°)."""
    parts = []
    for m in misfit.values():
        parts.append((m.gain_db**2 - m.noise_db**2) * (np.log(10) / 20) ** 2)
        parts.append((m.phase_deg**2 - m.noise_deg**2) * np.radians(1) ** 2)
    return float(np.sqrt(max(np.mean(parts), 0.0)))


@dataclass(frozen=True)
class ChainFit:
    """One chain, fitted."""

    model: Model
    standard_errors: dict[str, float]
    misfit: dict[str, Misfit]
    cost: float
    excess: float = 0.0
    """Rms of the logarithmic misfit beyond noise, by the weights of the fit: see `excess_of`."""

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the rows of `response`."""
        return OUTPUTS

    def response(self, frequency_hz: Array) -> ComplexArray:
        """Responses of all three outputs (3 x F), dead time included."""
        return chain_response(self.model.kind, self.model.parameters, frequency_hz)

    @property
    def explains(self) -> bool:
        """Whether every output is explained."""
        return all(misfit.explained for misfit in self.misfit.values())

    def doubt(self, *, corrected: bool = False) -> str:
        """Why its parameters may be off by more than their standard errors; '' if they hold.

        Args:
            corrected: whether channels were put in step first, which standard errors know nothing of.
        """
        allowed = TRUSTED_EXCESS / 2 if corrected else TRUSTED_EXCESS
        if self.explains and self.excess <= allowed:
            return ""
        return (
            f"the chain misses the measured responses by {share(self.excess)} rms beyond noise "
            f"({allowed:.0%} is allowed): its parameters may be off by more than their standard "
            "errors; look for channels out of step, or for an effect that it lacks (hil diagnose)"
        )

    @property
    def size(self) -> float:
        """Rms of the logarithmic misfit over all outputs, noise taken off (1 = a factor e or 57°)."""
        return size_of(self.misfit)


@dataclass(frozen=True)
class ChainChoice:
    """All chains, smallest first, the one to use, and why."""

    fits: tuple[ChainFit, ...]
    chosen: int
    reason: str

    @property
    def best(self) -> ChainFit:
        """The chain to use."""
        return self.fits[self.chosen]


def choose_chain(
    frf: FrequencyResponse,
    *,
    gear_ratio: float | None = None,
    torque_delay_s: float | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> ChainChoice:
    """Fit all three chains and take the smallest that explains the data.

    A chain explains the data when each output is within 1.5 dB and 10 degrees rms beyond noise, and no
    larger chain leaves less than half of its misfit. If none does, the best one is taken and the
    reason says so.

    Args:
        frf: the data; at least motor speed and one more output.
        gear_ratio: known gear ratio; estimated when None.
        torque_delay_s: known dead time; estimated when None. A chain that is too simple abuses the dead
            time to make up for the poles that it lacks, so the one of a rational fit is the better guess.
        progress: called with what is being done.
    """
    fits = []
    for kind in CHAINS:
        progress(kind.replace("_", " "))
        fits.append(fit_chain(frf, kind, gear_ratio=gear_ratio, torque_delay_s=torque_delay_s))
    for i, one in enumerate(fits):
        better = [o for o in fits[i + 1 :] if o.size < _HALVED * one.size and one.size > _NOTICEABLE]
        if one.explains and not better:
            return ChainChoice(tuple(fits), i, f"{one.model.kind} is the smallest that explains the data")
    best = int(np.argmin([one.size for one in fits]))
    reason = f"no chain explains the data within {TOLERANCE_DB:g} dB and {TOLERANCE_DEG:g} degrees rms"
    return ChainChoice(tuple(fits), best, f"{reason}; {fits[best].model.kind} comes closest")


def fit_chain(
    frf: FrequencyResponse,
    kind: str,
    *,
    gear_ratio: float | None = None,
    torque_delay_s: float | None = None,
) -> ChainFit:
    """Fit one chain to the logarithm of the response (gain and phase alike), from several starts.

    A value counts in full while its noise is below 3 %, and less above.

    Raises:
        BadInputError: unknown kind, or without motor speed and another output.
    """
    from scipy.optimize import least_squares

    if kind not in CHAINS:
        raise BadInputError(f"unknown chain '{kind}'", fix=f"chains: {', '.join(CHAINS)}")
    if OUTPUTS[0] not in frf.outputs or len(frf.outputs) < 2:
        raise BadInputError(
            f"a chain needs '{OUTPUTS[0]}' and another output; there are: {', '.join(frf.outputs)}"
        )
    known = {"gear_ratio": gear_ratio, "torque_delay": torque_delay_s}
    problem = ChainProblem(frf, kind, {name: value for name, value in known.items() if value is not None})
    # Levenberg-Marquardt of MINPACK: for so few unknowns faster than scipy's own bounded search.
    solutions = [
        least_squares(problem.residual, problem.logarithms(start), method="lm", max_nfev=500, ftol=1e-9)
        for start in starts_of(frf, kind, gear_ratio)
    ]
    solution = min(solutions, key=lambda s: float(s.cost))
    values = problem.parameters(solution.x)
    freedom = max(len(solution.fun) - len(problem.names), 1)
    jacobian = np.asarray(solution.jac)
    covariance = np.linalg.pinv(jacobian.T @ jacobian) * 2 * float(solution.cost) / freedom
    errors = {
        name: float(values[name] * np.sqrt(max(c, 0.0)))
        for name, c in zip(problem.names, np.diag(covariance), strict=True)
    }
    response, cost = problem.response(values), float(solution.cost)
    found = misfit_of(response, frf)
    return ChainFit(Model(kind, values), errors, found, cost, excess_of(response, frf))


def excess_of(model: ComplexArray, frf: FrequencyResponse) -> float:
    """Rms of the logarithmic misfit beyond noise (1 = a factor e or 57°).

    Values count by how sure they are, as in the fit, and none for more than `_FAR`: at a frequency that the
    input hardly excites a phase may be anything.
    """
    relative = _relative_deviation(frf)
    weight = 1 / np.hypot(1.0, relative / _USUAL_MODEL_ERROR) ** 2
    error = np.minimum(np.abs(np.log(model / frf.response)), _FAR)
    beyond = np.sum(weight * (error**2 - np.minimum(relative, _FAR) ** 2)) / np.sum(weight)
    return float(np.sqrt(max(beyond, 0.0)))


class ChainProblem:
    """Logarithmic misfit as a function of the logarithms of the unknown parameters."""

    def __init__(self, frf: FrequencyResponse, kind: str, known: dict[str, float]) -> None:
        self._frf = frf
        self._kind = kind
        self._known = known
        self._rows = [OUTPUTS.index(name) for name in frf.outputs]
        self._weight = 1 / np.hypot(1.0, _relative_deviation(frf) / _USUAL_MODEL_ERROR)
        self.names = [n for n in parameter_names(kind) if n not in known]
        self._low = np.log([_SMALLEST.get(n, 1e-6) for n in self.names])
        self._high = np.log([_LARGEST.get(n, 1e9) for n in self.names])

    def logarithms(self, values: dict[str, float]) -> Array:
        return np.asarray(np.log([values[n] for n in self.names]))

    def parameters(self, theta: Array) -> dict[str, float]:
        """All parameters in file order, kept within what makes sense."""
        found = np.exp(np.clip(theta, self._low, self._high))
        values = self._known | dict(zip(self.names, found.tolist(), strict=True))
        return {name: values[name] for name in parameter_names(self._kind)}

    def response(self, values: dict[str, float]) -> ComplexArray:
        return np.asarray(chain_response(self._kind, values, self._frf.frequency_hz)[self._rows])

    def residual(self, theta: Array) -> Array:
        return self.residual_of(self.response(self.parameters(theta)))

    def residual_of(self, response: ComplexArray) -> Array:
        """Of any response of the outputs of the data, weighted, gain before phase."""
        error = self._weight * np.log(response / self._frf.response)
        return np.concatenate([error.real.ravel(), error.imag.ravel()])


def _relative_deviation(frf: FrequencyResponse) -> Array:
    return np.asarray(frf.standard_deviation / np.abs(frf.response))


def misfit_of(model: ComplexArray, frf: FrequencyResponse) -> dict[str, Misfit]:
    relative = _relative_deviation(frf)
    logarithm = np.log(model / frf.response)
    found = {}
    for row, name in enumerate(frf.outputs):
        measured = relative[row] <= _FAR  # elsewhere a phase may be anything
        measured |= not measured.any()
        error = logarithm[row, measured]
        # Half of the complex variance lies along the response (gain), half across (phase).
        noise = float(np.sqrt(np.mean(np.minimum(relative[row, measured], 1.0) ** 2) / 2))
        found[name] = Misfit(
            float(np.sqrt(np.mean(error.real**2)) * 20 / np.log(10)),
            float(np.degrees(np.sqrt(np.mean(error.imag**2)))),
            float(noise * 20 / np.log(10)),
            float(np.degrees(noise)),
        )
    return found


def starts_of(frf: FrequencyResponse, kind: str, gear_ratio: float | None) -> Iterator[dict[str, float]]:
    """Starting values: ratio and inertia from the lowest frequencies, stiffness from the gain's peak."""
    omega = 2 * np.pi * frf.frequency_hz
    lowest = slice(0, max(3, len(omega) // 20))
    speed = np.abs(frf.of(OUTPUTS[0]))
    ratio = gear_ratio or _ratio(frf, lowest)
    total = float(np.median(1 / (speed[lowest] * omega[lowest])))
    common = {"gear_ratio": ratio, "torque_delay": 0.005}
    if kind == "rigid":
        inertia = 0.05 * total
        yield common | {
            "motor_inertia": inertia,
            "vehicle_inertia": (total - inertia) * ratio**2,
            "viscous_drag": 1e-3,
        }
        return
    upper = omega > 2 * np.pi * 2.0
    scaled = np.where(upper, speed * omega, 0.0)
    resonance = float(omega[np.argmax(scaled)]) if upper.any() else float(omega[-1])
    rotor = float(1 / np.median(speed[-5:] * omega[-5:]))
    for rotor_inertia in (rotor, 0.02):
        inertia = min(rotor_inertia, 0.5 * total)
        stiffness = resonance**2 * inertia * ratio**2
        chain = common | {
            "motor_inertia": inertia,
            "vehicle_inertia": (total - inertia) * ratio**2,
            "shaft_stiffness": stiffness,
            "shaft_damping": 0.1 * stiffness / resonance,
        }
        if kind == "two_inertia":
            yield chain
            continue
        for part, softness in ((0.015, 1.0), (0.05, 0.3), (0.015, 10.0)):
            yield chain | {
                "wheel_inertia": part * chain["vehicle_inertia"],
                "tyre_stiffness": softness * stiffness,
                "tyre_damping": 0.5 * softness * stiffness / resonance,
            }


def _ratio(frf: FrequencyResponse, lowest: slice) -> float:
    speed = np.abs(frf.of(OUTPUTS[0])[lowest])
    if OUTPUTS[1] in frf.outputs:
        return float(np.median(speed / np.abs(frf.of(OUTPUTS[1])[lowest])))
    return float(np.median(np.abs(frf.of(OUTPUTS[2])[lowest])))
