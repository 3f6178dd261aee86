"""Whether channels are in step: what comes late, and what is averaged or held, against a driveline chain.

Two devices have clocks and filters of their own. A chain ties its outputs to each other, so that a channel
that is late by τ, or averaged (or held) over w, shows against the others: its response is multiplied by
sinc(ω w/2) e^(-jωτ). A clock that runs at another rate makes τ grow with the moment at which a chirp passes
each frequency. What all channels have in common is the torque's dead time or the inverter's lag and cannot
be distinguished from it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import numpy.typing as npt

from hil.analysis.frequency_response import Experiment, FrequencyResponse
from hil.analysis.identification._chain_fit import ChainProblem, excess_of, fit_chain, starts_of
from hil.core.channels import OUTPUTS

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_KIND = "three_inertia"
_SURE = 5.0  # standard errors
_LEAST_LATE_S, _LEAST_WIDTH_S, _LEAST_DRIFT = 2e-4, 1e-3, 2e-6
#: Rms of the logarithm that a chain with these timings leaves beyond noise, and of what it leaves without.
_EXPLAINED, _SHRUNK = 0.03, 0.5
_LONGEST_S = 0.1
_FAR_S = 0.03
_LEAST_VALUES = 60  # complex ones, for 14 unknowns
_SCALE = {"late": 1e-3, "width": 1e-6, "drift": 1e-6}  # s, s² and s/s: steps of the search
_LEAST = {"late": _LEAST_LATE_S, "width": _LEAST_WIDTH_S**2, "drift": _LEAST_DRIFT}
_Unknown = tuple[Literal["late", "width", "drift"], str]


@dataclass(frozen=True)
class Timing:
    """How late a channel comes after the earliest one, and over how long its values are averaged or held, s.

    What is averaged or held over w is late by w/2 by that alone, which is part of `late_s`.
    """

    late_s: float
    late_error_s: float
    width_s: float
    width_error_s: float
    drift: float = 0.0
    drift_error: float = 0.0

    def factor(self, frequency_hz: Array, moment_s: Array) -> ComplexArray:
        """What the channel's response is multiplied by; `moment_s`: see `moments_of`."""
        late_s = self.late_s + self.drift * moment_s
        held = np.sinc(frequency_hz * self.width_s)
        return np.asarray(held * np.exp(-2j * np.pi * frequency_hz * late_s))

    def in_words(self, channel: str) -> str:
        """A sentence."""
        parts = []
        if self.late_s:
            late = _ms(self.late_s, self.late_error_s)
            parts.append(f"comes {late} later than the earliest channel")
        if self.width_s:
            parts.append(f"is averaged or held over {_ms(self.width_s, self.width_error_s)}")
        if self.drift:
            ppm = f"{abs(1e6 * self.drift):.3g} ± {1e6 * self.drift_error:.1g} ppm"
            parts.append(f"has a clock that runs {ppm} {'fast' if self.drift < 0 else 'slow'}")
        return f"'{channel}' {' and '.join(parts)}"


def _ms(value_s: float, error_s: float) -> str:
    return f"{1e3 * value_s:.3g} ± {1e3 * error_s:.1g} ms"


def moments_of(experiments: Sequence[Experiment], frequency_hz: Array) -> Array:
    """When the inputs passed each frequency, s from the middle: for a multisine always 0."""
    from scipy.signal import stft

    power, moment = np.zeros(len(frequency_hz)), np.zeros(len(frequency_hz))
    for one in experiments:
        rate_hz = 1 / one.sample_time_s
        length = min(len(one.input), max(256, round(rate_hz / max(frequency_hz[0], 0.5))))
        found_hz, found_s, spectrum = stft(one.input, rate_hz, nperseg=length)
        density = np.abs(spectrum) ** 2
        total = density.sum(axis=1)
        mean = density @ found_s / np.maximum(total, 1e-300)
        power += np.interp(frequency_hz, found_hz, total)
        moment += np.interp(frequency_hz, found_hz, total * mean)
    moments = moment / np.maximum(power, 1e-300)
    return np.asarray(moments - np.mean(moments))


def timings_of(frf: FrequencyResponse, moment_s: Array, gear_ratio: float | None = None) -> dict[str, Timing]:
    """Timings of the channels that are surely out of step, by name.

    There are none if no chain explains the data with them, or if a chain explains as much without.
    """
    if OUTPUTS[0] not in frf.outputs or len(frf.outputs) < 2 or frf.response.size < _LEAST_VALUES:
        return {}
    search = _Search(frf, moment_s, gear_ratio)
    free, begins = search.all_unknowns, search.far_apart()
    while free:
        found = search.fit(free, begins)
        if found.excess > _EXPLAINED:
            return {}  # with fewer timings no chain explains more
        kept = [one for one in free if found.is_sure(one)]
        if kept == free:
            break
        weakest = min((one for one in free if one not in kept), key=found.sureness)
        free = [one for one in free if one != weakest]
        begins = [found.late_s] if found.late_s else []
    else:
        return {}
    if all(("width", name) in free for name in frf.outputs):
        return {}  # all of them alike: the inverter's lag, which is no channel's
    plain = fit_chain(frf, _KIND, gear_ratio=gear_ratio)
    if found.cost > _SHRUNK * plain.cost:
        return {}
    return found.timings()


@dataclass(frozen=True)
class _Fitted:
    """Timings that were fitted with a chain: `values` and `errors` by unknown, as `_Search` has them."""

    outputs: tuple[str, ...]
    values: Mapping[_Unknown, float]
    errors: Mapping[_Unknown, float]
    excess: float
    cost: float

    def sureness(self, unknown: _Unknown) -> float:
        """How many standard errors it is from nothing; 0 of what is too small to matter."""
        value, error = self.values[unknown], max(self.errors[unknown], 1e-12)
        least = _LEAST[unknown[0]]
        if unknown[0] == "width" and value <= 0.0:
            return 0.0
        return abs(value) / error if abs(value) >= least else 0.0

    def is_sure(self, unknown: _Unknown) -> bool:
        return self.sureness(unknown) >= _SURE

    @property
    def late_s(self) -> dict[str, float]:
        """How late each channel is of which that was fitted, after the first channel."""
        return {name: value for (kind, name), value in self.values.items() if kind == "late"}

    def timings(self) -> dict[str, Timing]:
        """Of each channel that is out of step; the earliest one is in step."""
        late = dict.fromkeys(self.outputs, 0.0) | self.late_s
        earliest = min(late.values())
        error = max((self.errors[one] for one in self.values if one[0] == "late"), default=0.0)
        found = {}
        for name in self.outputs:
            beyond = late[name] - earliest
            beyond = beyond if beyond >= max(_LEAST_LATE_S, _SURE * error) else 0.0
            width = float(np.sqrt(max(self.values.get(("width", name), 0.0), 0.0)))
            width_error = self.errors[("width", name)] / (2 * width) if width else 0.0
            drift = self.values.get(("drift", name), 0.0)
            if beyond or width or drift:
                found[name] = Timing(
                    beyond, error, width, width_error, drift, self.errors.get(("drift", name), 0.0)
                )
        return found


class _Search:
    """A chain together with timings: `late` of every channel but the first, and the square of each `width`.

    The square, for a channel that is averaged little may come out below nothing.
    """

    def __init__(self, frf: FrequencyResponse, moment_s: Array, gear_ratio: float | None) -> None:
        known = {} if gear_ratio is None else {"gear_ratio": gear_ratio}
        self._frf, self._problem = frf, ChainProblem(frf, _KIND, known)
        self._moment_s = moment_s
        self._starts = [self._problem.logarithms(start) for start in starts_of(frf, _KIND, gear_ratio)]
        late: list[_Unknown] = [("late", name) for name in frf.outputs[1:]]
        drifts: list[_Unknown] = [("drift", name) for name in frf.outputs[1:]] if np.ptp(moment_s) else []
        self.all_unknowns: list[_Unknown] = [*late, *drifts, *(("width", name) for name in frf.outputs)]

    def fit(self, free: list[_Unknown], begins: Sequence[Mapping[str, float]]) -> _Fitted:
        """The best chain with these timings.

        Args:
            begins: lateness (s, by channel) to begin with again if a search from 0 explains too little.
        """
        found = self._best_from({}, free)
        if found.excess > _EXPLAINED:
            again = [self._best_from(begin_s, free, most=200) for begin_s in begins]
            found = min([found, *again], key=lambda one: one.cost)
        return found

    def _best_from(self, begin_s: Mapping[str, float], free: list[_Unknown], most: int = 600) -> _Fitted:
        from scipy.optimize import least_squares

        count = len(self._starts[0])
        scale = np.array([_SCALE[kind] for kind, _ in free])

        def response(theta: Array) -> ComplexArray:
            chain = self._problem.response(self._problem.parameters(theta[:count]))
            return chain * self._factors(dict(zip(free, theta[count:] * scale, strict=True)))

        def residual(theta: Array) -> Array:
            return self._problem.residual_of(response(theta))

        first = [begin_s.get(name, 0.0) if kind == "late" else 0.0 for kind, name in free] / scale
        common_s = max(0.0, -min(begin_s.values(), default=0.0))
        starts = [np.r_[self._delayed(start, common_s), first] for start in self._starts]
        solutions = [
            least_squares(residual, start, method="lm", max_nfev=most, ftol=1e-9) for start in starts
        ]
        best = min(solutions, key=lambda one: float(one.cost))
        jacobian = np.asarray(best.jac)
        freedom = max(len(best.fun) - len(best.x), 1)
        covariance = np.linalg.pinv(jacobian.T @ jacobian) * 2 * float(best.cost) / freedom
        errors = np.sqrt(np.maximum(np.diag(covariance)[count:], 0.0)) * scale
        return _Fitted(
            self._frf.outputs,
            dict(zip(free, (best.x[count:] * scale).tolist(), strict=True)),
            dict(zip(free, errors.tolist(), strict=True)),
            excess_of(response(best.x), self._frf),
            float(best.cost),
        )

    def far_apart(self) -> list[dict[str, float]]:
        """Where a search begins when one from 0 ends in another minimum: one channel late, or all but it."""
        others = self._frf.outputs[1:]  # `late` counts from the first
        alone = [{name: sign * _FAR_S} for name in others for sign in (1.0, -1.0)]
        together = [dict.fromkeys(others, sign * _FAR_S) for sign in (1.0, -1.0)]
        return together if len(others) == 1 else [*together, *alone]

    def _delayed(self, start: Array, later_s: float) -> Array:
        """The start of a chain with a longer dead time."""
        names = self._problem.names
        if "torque_delay" not in names or not later_s:
            return start
        moved = start.copy()
        at = names.index("torque_delay")
        moved[at] = np.log(np.exp(start[at]) + later_s)
        return moved

    def _factors(self, values: Mapping[_Unknown, float]) -> ComplexArray:
        """Outputs x frequencies."""
        frequency_hz = self._frf.frequency_hz
        factors = np.ones((len(self._frf.outputs), len(frequency_hz)), complex)
        for (kind, name), value in values.items():
            row = self._frf.outputs.index(name)
            if kind == "late":
                factors[row] *= np.exp(-2j * np.pi * frequency_hz * np.clip(value, -_LONGEST_S, _LONGEST_S))
            elif kind == "drift":
                factors[row] *= np.exp(-2j * np.pi * frequency_hz * value * self._moment_s)
            else:
                factors[row] *= _held(frequency_hz, float(np.clip(value, -(_LONGEST_S**2), _LONGEST_S**2)))
        return factors


def _held(frequency_hz: Array, square_s2: float) -> Array:
    """sinc(f w) as a smooth function of w², and its delay of w/2 left to `late`."""
    x = np.pi * frequency_hz * np.sqrt(abs(square_s2))
    x = np.maximum(x, 1e-9)
    value = np.sin(x) / x if square_s2 >= 0.0 else np.sinh(x) / x
    return np.asarray(np.maximum(value, 1e-3))


def in_step(frf: FrequencyResponse, timings: Mapping[str, Timing], moment_s: Array) -> FrequencyResponse:
    """The response as it would be if no channel were late, averaged or held."""
    factors = np.ones((len(frf.outputs), len(frf.frequency_hz)), complex)
    for row, name in enumerate(frf.outputs):
        if name in timings:
            factors[row] = timings[name].factor(frf.frequency_hz, moment_s)
    gains = np.abs(factors)
    return replace(
        frf,
        response=frf.response / factors,
        standard_deviation=frf.standard_deviation / gains,
        nonlinear=frf.nonlinear / gains if np.size(frf.nonlinear) else frf.nonlinear,
    )
