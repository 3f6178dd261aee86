"""Units, signs and columns that were mistaken: seen by what the model says to the same torque.

Such a mistake has no number that could be fitted: it is there or not. So each is undone, and the model is
asked which recording it knows. A mistake is named only where a channel as it stands is nothing like the model
and mended every channel is like it; no missing effect and no wrong parameter does both.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data.thresholds import (
    ALIKE,
    BAND_SHARE,
    LEAST_BANDS,
    MISTAKE_BANDS_HZ,
    MISTAKE_TREND,
    SHOWS,
    UNLIKE,
)
from hil.analysis.diagnosis.data.trace import Trace
from hil.analysis.diagnosis.data.turns import around
from hil.core.channels import INPUT, OUTPUTS
from hil.core.errors import BadInputError
from hil.core.model import Model
from hil.plant import gear_ratio_of, pack, sensor_of, simulate_many

Array = npt.NDArray[np.float64]

_MOTOR, _WHEEL, _SHAFT = OUTPUTS
_PER_RPM = 2.0 * np.pi / 60.0


@dataclass(frozen=True)
class _Mistake:
    """What may have been mistaken: factors that mend torque and outputs, and outputs that are exchanged."""

    what: str
    fix: str
    torque: float = 1.0
    outputs: tuple[float, float, float] = (1.0, 1.0, 1.0)
    exchanged: bool = False

    def undone(self, trace: Trace) -> Trace:
        """The recording without the mistake."""
        order = [1, 0, 2] if self.exchanged else [0, 1, 2]
        factor = np.array(self.outputs)
        return dataclasses.replace(
            trace,
            torque=trace.torque * self.torque,
            samples=trace.samples[:, order] * factor,
            measured=trace.measured[:, order] * factor,
            start=trace.start[order] * factor,
        )


def _outputs(column: int, factor: float) -> tuple[float, float, float]:
    factors = [1.0, 1.0, 1.0]
    factors[column] = factor
    return factors[0], factors[1], factors[2]


_SIGN, _RPM, _KNM = "invert the sign of the channel", "multiply it by 2π/60", "multiply it by 1000"
_MISTAKES = (
    *(_Mistake(f"{name} looks inverted", _SIGN, 1.0, _outputs(c, -1.0)) for c, name in enumerate(OUTPUTS)),
    _Mistake(f"{INPUT} looks inverted: the axle does the opposite", _SIGN, -1.0),
    _Mistake(f"{_MOTOR} and {_WHEEL} look inverted", "invert the sign of both", 1.0, (-1.0, -1.0, 1.0)),
    _Mistake(f"{_MOTOR} and {_WHEEL} look swapped", "exchange the two columns", exchanged=True),
    _Mistake(f"{_MOTOR} looks like rpm", _RPM, 1.0, _outputs(0, _PER_RPM)),
    _Mistake(f"{_WHEEL} looks like rpm", _RPM, 1.0, _outputs(1, _PER_RPM)),
    _Mistake(
        f"{_MOTOR} and {_WHEEL} look like rpm", "multiply both by 2π/60", 1.0, (_PER_RPM, _PER_RPM, 1.0)
    ),
    _Mistake(f"{_SHAFT} looks like kN m", _KNM, 1.0, _outputs(2, 1000.0)),
    _Mistake(f"{INPUT} looks like kN m", _KNM, 1000.0),
    _Mistake(f"{INPUT} and {_SHAFT} look like kN m", "multiply both by 1000", 1000.0, _outputs(2, 1000.0)),
)


def mistaken(model: Model, traces: Sequence[Trace], noise: Array) -> BadInputError | None:
    """The mistake that explains what nothing else does, if there is one.

    Args:
        noise: standard deviation of each output per sample, shape (3,).
    """
    given = _Likeness.of(model, traces, noise)
    if not np.any(given.channels() > UNLIKE):
        return None
    found: list[tuple[float, _Mistake]] = []
    for mistake in _MISTAKES:
        undone = [mistake.undone(trace) for trace in traces]
        mended = _Likeness.of(model, undone, noise * np.abs(np.array(mistake.outputs)))
        channels = mended.channels()
        if np.any(np.isfinite(given.channels()) & ~(channels <= ALIKE)):
            continue
        turned = mistake.torque < 0.0 or min(mistake.outputs) < 0.0
        # a resonance that lies elsewhere turns the sign of a narrow band by itself
        better = np.any((given.bands() > UNLIKE) & (mended.bands() < ALIKE), axis=1)
        if not turned or np.count_nonzero(better) >= LEAST_BANDS:
            found.append((float(np.nanmean(channels)), mistake))
    if not found:
        return None
    best = min(found, key=lambda one: one[0])[1]
    return BadInputError(
        f"{best.what}: the model explains almost nothing of the data, and almost all after this correction",
        fix=f"{best.fix}; or check that the model belongs to this axle",
    )


@dataclass(frozen=True)
class _Likeness:
    """Power of recordings and model together, and of their difference, bands x channels."""

    apart: Array
    size: Array
    shown: npt.NDArray[np.bool_]

    @classmethod
    def of(cls, model: Model, traces: Sequence[Trace], noise: Array) -> _Likeness:
        """Compare recordings with what the model says to their torque."""
        apart, size, least = (np.zeros((len(MISTAKE_BANDS_HZ) - 1, 3)) for _ in range(3))
        for trace in traces:
            seen, simulated = _spectra(trace.measured), _spectra(_simulated(model, trace))
            lines = np.fft.rfftfreq(len(trace.measured), trace.dt * trace.block)
            for band, (low, high) in enumerate(pairwise(MISTAKE_BANDS_HZ)):
                inside = (lines >= low) & (lines < high)
                apart[band] += np.sum(np.abs(seen[inside] - simulated[inside]) ** 2, axis=0)
                size[band] += np.sum(np.abs(seen[inside]) ** 2 + np.abs(simulated[inside]) ** 2, axis=0)
                share = np.count_nonzero(inside) / len(lines)
                least[band] += share * len(trace.measured) * np.nan_to_num(noise) ** 2 / trace.block
        known = np.isfinite(size) & (size > SHOWS * least) & (size > 0.0)
        return cls(apart, size, known & (size > BAND_SHARE * np.nansum(size, axis=0)))

    def bands(self) -> Array:
        """How unlike they are: 0 alike, 1 unrelated, 2 opposite; NaN where nothing shows beyond noise."""
        return np.where(self.shown, self.apart / np.where(self.shown, self.size, 1.0), np.nan)

    def channels(self) -> Array:
        """The same over all bands."""
        size = np.sum(np.where(self.shown, self.size, 0.0), axis=0)
        apart = np.sum(np.where(self.shown, self.apart, 0.0), axis=0)
        return np.where(size > 0.0, apart / np.where(size > 0.0, size, 1.0), np.nan)


def _simulated(model: Model, trace: Trace) -> Array:
    """What a model shows of a recording's torque, from its own start: blocks x 3, NaN where not measured."""
    ratio = gear_ratio_of(model) or 1.0
    motor, wheel, shaft = (float(value) for value in trace.start)
    if not np.isfinite(motor):
        motor = wheel * ratio if np.isfinite(wheel) else 0.0
    if not np.isfinite(wheel):
        wheel = motor / ratio
    start = np.array([[motor, wheel, shaft if np.isfinite(shaft) else 0.0]])
    sensors = np.stack([sensor_of(model, channel) for channel in OUTPUTS])[None]
    angles = trace.angles(ratio)
    functions = model.transfer_functions
    simulated = simulate_many(
        pack(model)[None], trace.torque, trace.dt, start, sensors, trace.block, angles, trace.load, functions
    )[0]
    return np.where(trace.has, simulated, np.nan)


def _spectra(values: Array) -> Array:
    """Spectra of channels (blocks x 3) about their trend; NaN where not measured."""
    known = np.nan_to_num(values, nan=0.0, posinf=0.0, neginf=0.0)
    window = np.hanning(len(values) + 1)[:-1, None]
    spectra = np.fft.rfft(around(MISTAKE_TREND, known) * window, axis=0)
    return np.where(np.all(np.isnan(values), axis=0), np.nan, spectra)
