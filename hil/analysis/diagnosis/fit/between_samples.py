"""What a seldom read request did between its samples: held or smooth, whichever the base model explains."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data.request import is_stepped, smooth
from hil.analysis.diagnosis.data.thresholds import COARSE_SAMPLE_S
from hil.analysis.diagnosis.data.trace import Trace
from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.fit import fit
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.fit.simulated import simulated_samples
from hil.analysis.diagnosis.fit.thresholds import SMOOTHER, UNSURE

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Requests:
    """Recordings with their requests as they were likelier, and notes on those that were read too seldom.

    `unsure` is what is not known of each channel for that reason, standard deviation of a sample (3,).
    """

    traces: list[Trace]
    notes: list[str]
    unsure: Array


def likelier_requests(
    traces: Sequence[Trace], base: Hypothesis, problem_of_one: Callable[[Trace], Problem]
) -> Requests:
    """What the requests of coarsely sampled recordings did between samples.

    Dead time of half a sample and a smooth request look much alike: no one can tell them apart at this rate.

    Args:
        problem_of_one: makes a recording ready to be fitted alone.
    """
    found, notes = [], []
    squares, count = np.zeros(3), 0  # of what is not known
    for trace in traces:
        count += len(trace.samples)
        if trace.dt <= COARSE_SAMPLE_S:
            found.append(trace)
            continue
        fits = []
        for one in (trace, smooth(trace)):
            problem = problem_of_one(one)
            fits.append((fit(problem, base), problem))
        (held, _), (smoothed, _) = fits
        shown = [simulated_samples(p, f.hypothesis, held.theta, held.starts)[0] for f, p in fits]
        unsure = UNSURE[is_stepped(trace)] * (shown[0] - shown[1])
        squares += np.nan_to_num(np.sum(unsure**2, axis=0))
        better = smoothed.total < SMOOTHER * held.total
        found.append(fits[better][1].traces[0])
        notes.append(_note(trace, "smooth between them" if better else "held from one to the next"))
    return Requests(found, notes, np.sqrt(squares / max(count, 1)))


def _note(trace: Trace, taken: str) -> str:
    return (
        f"{trace.name} is sampled at {1.0 / trace.dt:.4g} Hz: torque between samples is not known; it is "
        f"taken as {taken}, which the base model explains better. What that leaves open counts as noise; "
        f"{500.0 * trace.dt:.2g} ms of dead time may be no more than that"
    )
