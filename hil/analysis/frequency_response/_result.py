"""A frequency response as measured: values, how sure they are, and its table on disk."""

from __future__ import annotations

import io
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt

from hil.core.channels import OUTPUTS
from hil.core.errors import BadInputError
from hil.core.files import read_text

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]


@dataclass(frozen=True)
class Distortion:
    """Output at frequencies that the input leaves out (Pintelon & Schoukens, 2nd ed., ch. 4).

    Levels are root mean squares of one spectral line, in the output's unit; `noise` is the level that
    period-to-period scatter alone would give at the same lines. Arrays are outputs x lines. `share` has one
    value an output: the larger of odd and even level beyond noise, relative to the linear response to the
    neighbouring lines (median over lines).
    """

    odd_frequency_hz: Array
    odd: Array
    odd_noise: Array
    even_frequency_hz: Array
    even: Array
    even_noise: Array
    share: Array = field(default_factory=lambda: np.empty(0))


@dataclass(frozen=True)
class FrequencyResponse:
    """Responses from one input to some outputs, with their uncertainty.

    Attributes:
        frequency_hz: F frequencies, increasing.
        outputs: names of the O output channels.
        response: O x F complex values, output unit per input unit.
        coherence: O x F, share of the output's power that the input explains, 0 to 1.
        standard_deviation: O x F, sqrt(E|estimate - truth|²) from noise (and, with several random-phase
            realisations, from stochastic nonlinear distortion).
        noise: O x F, output noise as a one-sided amplitude density, output unit/√Hz.
        nonlinear: O x F, the part of `standard_deviation` that repeats with the input (stochastic
            nonlinear distortion); zeros where it cannot be distinguished.
        independent_every: neighbours share data; every `independent_every`-th value is independent.
        method: how it was estimated.
        notes: what was mended, merged or left out.
        realisations: of random phases that were averaged, periodic method only.
        input_hold_s: zero-order hold of the input that is taken out of `response`; 0 if none was.
    """

    frequency_hz: Array
    outputs: tuple[str, ...]
    response: ComplexArray
    coherence: Array
    standard_deviation: Array
    noise: Array
    nonlinear: Array
    independent_every: int
    method: str
    distortion: Distortion | None = None
    notes: tuple[str, ...] = field(default=())
    realisations: int = 1
    input_hold_s: float = 0.0

    def of(self, output: str) -> ComplexArray:
        """Response of one output; KeyError if it was not estimated."""
        return np.asarray(self.response[self._row(output)])

    def deviation_of(self, output: str) -> Array:
        """Standard deviation of one output's response; KeyError if it was not estimated."""
        return np.asarray(self.standard_deviation[self._row(output)])

    def _row(self, output: str) -> int:
        if output not in self.outputs:
            raise KeyError(output)
        return self.outputs.index(output)


_HOLD = "input_hold_taken_out_s"
_COLUMNS = ("real", "imag", "gain_db", "phase_deg", "standard_deviation", "coherence", "noise", "nonlinear")


def frf_to_csv(frf: FrequencyResponse) -> str:
    """The table `frf.csv`: one row a frequency, columns `<output>.<quantity>`.

    Quantities: real, imag, gain_db (20 log10 of output unit per N m), phase_deg (unwrapped),
    standard_deviation, coherence, noise (unit/√Hz), nonlinear. The last column, the same in every row, is the
    zero-order hold of the input that is taken out of all responses.
    """
    columns: dict[str, Array] = {"frequency_hz": frf.frequency_hz}
    for row, output in enumerate(frf.outputs):
        response = frf.response[row]
        values = (
            response.real,
            response.imag,
            20 * np.log10(np.abs(response)),
            np.degrees(np.unwrap(np.angle(response))),
            frf.standard_deviation[row],
            frf.coherence[row],
            frf.noise[row],
            frf.nonlinear[row],
        )
        columns |= {f"{output}.{name}": value for name, value in zip(_COLUMNS, values, strict=True)}
    columns["independent_every"] = np.full(len(frf.frequency_hz), float(frf.independent_every))
    columns[_HOLD] = np.full(len(frf.frequency_hz), frf.input_hold_s)
    from pandas import DataFrame

    text = io.StringIO()
    DataFrame(columns).to_csv(text, index=False, float_format="%.9g", lineterminator="\n")
    return text.getvalue()


def frf_from_csv(path: Path) -> FrequencyResponse:
    """Read a table written by `frf_to_csv`.

    Raises:
        BadInputError: not a table, no `frequency_hz`, no output, or cells that are not numbers.
    """
    from pandas import read_csv
    from pandas.errors import ParserError

    try:
        frame = read_csv(io.StringIO(read_text(path)), dtype=float)
    except (ValueError, ParserError) as error:
        raise BadInputError(f"not a table of numbers: {error}", where=str(path)) from error
    outputs = tuple(name for name in OUTPUTS if f"{name}.real" in frame)
    if "frequency_hz" not in frame or not outputs:
        raise BadInputError("not a frequency response table", where=str(path), fix="give an frf.csv")

    def table(quantity: str) -> Array:
        names = [f"{output}.{quantity}" for output in outputs]
        return np.array([frame[n] if n in frame else np.zeros(len(frame)) for n in names], dtype=float)

    every = int(frame["independent_every"].iloc[0]) if "independent_every" in frame else 1
    return FrequencyResponse(
        frame["frequency_hz"].to_numpy(dtype=float),
        outputs,
        table("real") + 1j * table("imag"),
        table("coherence"),
        table("standard_deviation"),
        table("noise"),
        table("nonlinear"),
        every,
        "read from a table",
        input_hold_s=float(frame[_HOLD].iloc[0]) if _HOLD in frame else 0.0,
    )
