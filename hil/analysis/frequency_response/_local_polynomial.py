"""Local polynomial method: arbitrary data, leakage removed, noise estimated from the same record.

Pintelon, Schoukens, Vandersteen, Barbé, Mech. Syst. Signal Process. 24 (2010) 573-595: around each
frequency the response and the transient are smooth, so both are fitted as polynomials over the
neighbouring Fourier lines, Y = G·U + T. What is left is noise.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from hil.analysis.frequency_response._experiment import Lines
from hil.analysis.frequency_response._quality import UnfitDataError
from hil.analysis.frequency_response._result import FrequencyResponse

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_DEGREE = 2
_LEAST_FREEDOM = 8
_TRANSIENT_SHARE = 0.3
_CHANGE_SHARE = 0.5
_LOWEST_INPUT = 1e-9  # of the input's rms density: below, there is nothing to divide by


def local_polynomial(
    experiments: Sequence[Lines],
    output_names: tuple[str, ...],
    from_hz: float,
    to_hz: float,
    *,
    points: int = 400,
    joint: bool = False,
) -> FrequencyResponse:
    """Response at up to `points` frequencies, even on a logarithmic axis where the record is long enough.

    All experiments share the response and have their own transient. With `joint`, the reference excites:
    the responses reference → output and reference → input are estimated together and divided (joint
    input-output method), so that feedback does not bias the plant; their correlated noise is taken
    into account in the uncertainty.

    Args:
        experiments: Fourier lines of each experiment; they need not have the same spacing.
        output_names: O names.
        from_hz: lowest frequency of the result.
        to_hz: highest frequency of the result.
        points: largest number of frequencies.
        joint: use the reference.

    Raises:
        UnfitDataError: no_excitation at a frequency of the result.
    """
    half_lines = _half_width(len(experiments))
    spacing = min(float(lines.frequency_hz[1] - lines.frequency_hz[0]) for lines in experiments)
    centres, half_widths = _grid(from_hz, to_hz, points, half_lines * spacing)
    drive = [_driving(lines, joint) for lines in experiments]
    rms = np.sqrt(np.mean(np.concatenate([np.abs(u) ** 2 for u in drive])))
    shape = (len(output_names), len(centres))
    response = np.empty(shape, complex)
    variance, noise, power = np.empty(shape), np.empty(shape), np.empty(shape)
    for i, (centre, half) in enumerate(zip(centres, half_widths, strict=True)):
        rows = [_between(lines.frequency_hz, centre - half, centre + half) for lines in experiments]
        window = _Window(experiments, drive, rows, float(centre), float(half), joint)
        if window.drive_rms < _LOWEST_INPUT * rms:
            raise UnfitDataError("no_excitation", f"the input has no power at {centre:.4g} Hz")
        response[:, i], variance[:, i], noise[:, i], power[:, i] = window.estimate()
    omega = 2 * np.pi * centres
    explained = np.abs(response) ** 2 * power
    return FrequencyResponse(
        centres,
        output_names,
        response / (1j * omega),
        explained / np.maximum(explained + noise, np.finfo(float).tiny),
        np.sqrt(variance) / omega,
        np.sqrt(2 * noise) / omega,
        np.zeros(shape),
        _DEGREE + 1,
        "local polynomial, joint input-output" if joint else "local polynomial",
    )


def _half_width(experiments: int) -> int:
    """Fewest lines to each side that leave `_LEAST_FREEDOM` degrees of freedom."""
    unknowns = (_DEGREE + 1) * (1 + experiments)
    return int(np.ceil(((unknowns + _LEAST_FREEDOM) / experiments - 1) / 2))


def _grid(from_hz: float, to_hz: float, points: int, least_half_width: float) -> tuple[Array, Array]:
    """Centres and half widths of windows that hold three independent values each, three centres apart."""
    ratio = (to_hz / from_hz) ** (1 / max(points - 1, 1))
    per_window = _DEGREE + 1
    centres = [from_hz]
    while True:
        step = max(centres[-1] * (ratio - 1), 2 * least_half_width / per_window)
        if centres[-1] + step > to_hz * (1 + 1e-9):
            break
        centres.append(centres[-1] + step)
    stretch = np.log(to_hz / from_hz) / np.log(centres[-1] / from_hz) if len(centres) > 1 else 1.0
    middle = from_hz * (np.array(centres) / from_hz) ** stretch
    middle[-1] = max(to_hz, middle[0])  # the stretch ends there but for rounding
    half = np.maximum(0.5 * per_window * middle * (ratio - 1), least_half_width * (1 + 1e-9))
    return middle, half


def _between(frequency_hz: Array, low: float, high: float) -> slice:
    first = np.searchsorted(frequency_hz, low, side="left")
    return slice(int(first), int(np.searchsorted(frequency_hz, high, side="right")))


def _driving(lines: Lines, joint: bool) -> ComplexArray:
    if not joint:
        return lines.input
    if lines.reference is None:
        raise ValueError("the joint method needs a reference in every experiment")
    return lines.reference


class _Window:
    """The least-squares problem around one frequency."""

    def __init__(
        self,
        experiments: Sequence[Lines],
        drive: Sequence[ComplexArray],
        rows: Sequence[slice],
        centre: float,
        half: float,
        joint: bool,
    ) -> None:
        degrees = np.arange(_DEGREE + 1)
        self._joint = joint
        drives = [u[part] for u, part in zip(drive, rows, strict=True)]
        self.drive_rms = float(np.sqrt(np.mean(np.abs(np.concatenate(drives)) ** 2)))
        count = sum(len(u) for u in drives)
        width = (_DEGREE + 1) * (1 + len(drives))
        self._matrix = np.zeros((count, width), complex)
        self._data = np.empty((count, experiments[0].output_rate.shape[0] + joint), complex)
        self._input_power = float(
            np.mean(np.abs(np.concatenate([e.input[p] for e, p in zip(experiments, rows, strict=True)])) ** 2)
        )
        start = 0
        for number, (lines, part, u) in enumerate(zip(experiments, rows, drives, strict=True)):
            stop = start + len(u)
            powers = ((lines.frequency_hz[part] - centre) / half)[:, None] ** degrees
            column = (_DEGREE + 1) * (1 + number)
            self._matrix[start:stop, : _DEGREE + 1] = u[:, None] / max(self.drive_rms, 1e-300) * powers
            self._matrix[start:stop, column : column + _DEGREE + 1] = powers
            self._data[start:stop, int(joint) :] = lines.output_rate[:, part].T
            if joint:
                self._data[start:stop, 0] = lines.input[part]
            start = stop

    def estimate(self) -> tuple[ComplexArray, Array, Array, float]:
        """Response (O), its variance (O), noise density (O) and the input's power density."""
        gram = self._matrix.conj().T @ self._matrix
        projected = self._matrix.conj().T @ self._data
        free = self._data - self._matrix @ np.linalg.lstsq(self._matrix, self._data, rcond=1e-10)[0]
        freedom = max(len(self._data) - self._matrix.shape[1], 1)
        noise = np.sum(np.abs(free) ** 2, axis=0) / freedom
        power = np.mean(np.abs(self._data) ** 2, axis=0)
        columns = range(self._data.shape[1])
        posterior = [np.linalg.inv(gram + np.diag(self._precision(noise[c], power[c]))) for c in columns]
        solution = np.stack([posterior[c] @ projected[:, c] for c in columns], axis=1)
        gain = solution[0] / self.drive_rms
        spread = np.array([inverse[0, 0].real for inverse in posterior]) / self.drive_rms**2
        if not self._joint:
            return gain, spread * noise, noise, self._input_power
        plant = gain[1:] / gain[0]
        residual = self._data - self._matrix @ solution
        error = residual[:, 1:] - residual[:, :1] * plant
        noise = np.sum(np.abs(error) ** 2, axis=0) / freedom
        return plant, spread[1:] * noise / np.abs(gain[0]) ** 2, noise, self._input_power

    def _precision(self, noise: float, power: float) -> Array:
        """Weak prior knowledge, as noise variance over prior variance of each coefficient.

        Where a chirp begins and ends, its own lines are as smooth as the transient and data alone
        cannot tell the two apart. So the transient is expected below a third of the output, and the
        response's change within the window below half of the response. Elsewhere the data outweigh
        this by far; there the uncertainty grows accordingly.
        """
        ratio = noise / max(power, 1e-300)
        precision = np.full(self._matrix.shape[1], max(ratio, 1e-12) / _TRANSIENT_SHARE**2)
        precision[: _DEGREE + 1] = max(ratio, 1e-12) / _CHANGE_SHARE**2
        precision[0] = 0.0
        return precision
