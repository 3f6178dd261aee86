"""Channels that drift, in words: what a fit leaves in a channel that is slow, and that no other shows.

Noise of a sensor that is this slow proves nothing about the axle, and no effect of the registry is like it;
who reads that a gap is open wants to know which instrument to look at.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data._thresholds import DRIFT_S
from hil.analysis.diagnosis.data._trace import Trace
from hil.analysis.diagnosis.fit._problem import Problem
from hil.analysis.diagnosis.tell._thresholds import DRIFT_SHARE, DRIFTS_NOISES, SHARED
from hil.core.channels import OUTPUTS
from hil.core.errors.wording import multiple

Array = npt.NDArray[np.float64]

_UNITS = ("rad/s", "rad/s", "N m")


def drifts(problem: Problem, simulated: Sequence[Array]) -> list[str]:
    """Which channel drifts, by how much within how long: one sentence a channel, the largest drift each.

    Args:
        simulated: channels of each recording at full rate, n x 3, at the best fit.
    """
    errors = [_errors(t, shown) for t, shown in zip(problem.traces, simulated, strict=True)]
    slow = [_slow(error, trace) for error, trace in zip(errors, problem.traces, strict=True)]
    lines = []
    for column in range(3):
        mine = [i for i, t in enumerate(problem.traces) if t.has[column]]
        if not mine or _is_motion(problem, slow, column):
            continue
        # what white noise would leave: one part in sqrt(block) of a sample's, in every block
        white = float(problem.noise[column]) ** 2 / problem.traces[0].block
        whole = np.concatenate([errors[i][:, column] for i in mine])
        part = np.concatenate([slow[i][:, column] for i in mine])
        above = float(np.mean(whole**2)) - white
        swing, index = max((float(np.ptp(slow[i][:, column])), i) for i in mine)
        if swing < DRIFTS_NOISES * float(problem.noise[column]) or np.mean(part**2) < DRIFT_SHARE * above:
            continue
        trace = problem.traces[index]
        lasts, noises = len(trace.torque) * trace.dt, swing / float(problem.noise[column])
        lines.append(
            f"{OUTPUTS[column]} drifts slowly beside all else: by {swing:.3g} {_UNITS[column]} within the "
            f"{lasts:.3g} s of {trace.name}, {multiple(noises)} its noise"
        )
    return lines


def _errors(trace: Trace, shown: Array) -> Array:
    """Measured minus simulated, means over blocks x 3, 0 where not measured."""
    count = len(trace.measured)
    means = shown[: count * trace.block].reshape(count, trace.block, 3).mean(axis=1)
    return np.where(trace.has, trace.measured - means, 0.0)


def _slow(error: Array, trace: Trace) -> Array:
    """The part of an error that swings no faster than a drift."""
    lasts = len(error) * trace.block * trace.dt
    degree = 2 + round(np.pi * lasts / DRIFT_S)
    basis = np.linalg.qr(np.polynomial.legendre.legvander(np.linspace(-1.0, 1.0, len(error)), degree))[0]
    return np.asarray(basis @ (basis.T @ error))


def _is_motion(problem: Problem, slow: Sequence[Array], column: int) -> bool:
    """Whether the other speed shows the same: then the axle moves otherwise than simulated."""
    other = 1 - column
    if column > 1 or not all(t.has[column] and t.has[other] for t in problem.traces):
        return False
    scale = problem.gear_ratio if column == 0 else 1.0 / problem.gear_ratio
    mine = np.concatenate([s[:, column] for s in slow])
    apart = mine - scale * np.concatenate([s[:, other] for s in slow])
    return bool(np.mean(apart**2) < SHARED**2 * np.mean(mine**2))
