"""Whether a linear model says what the data say: trusted, doubted with reasons, or refused.

Fits always end somewhere. What tells a fit from a guess is what it leaves: the misfit beyond noise, the
distortion at lines that the input leaves out, and how much of the output the input explains at all.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import numpy.typing as npt

from hil.analysis.frequency_response import FrequencyResponse, check_coherence
from hil.analysis.identification._order import Candidate
from hil.analysis.identification._rational_fit import Fit, expected_deviation, fit
from hil.core.channels import COMFORT_BAND_HZ
from hil.core.errors import BadInputError
from hil.core.errors.wording import share

Array = npt.NDArray[np.float64]
Trust = Literal["linear", "doubtful"]

#: Relative to the response, median over frequency, noise taken off: beyond, the model is doubtful.
LARGEST_MISFIT = 0.05
#: The same as rms on frequencies left out of the fit, where single ones count more.
LARGEST_EXCESS = 0.25
#: Level at lines that the input leaves out, relative to the linear response around them, median.
LARGEST_DISTORTION = 0.05
#: Median coherence of a record that does not repeat: below, noise and distortion cannot be distinguished.
LEAST_COHERENCE = 0.97
#: Below it, inside the comfort band, less than half of an output's power there comes from the input.
UNSEEN_COHERENCE = 0.5
#: Misfit (of response) that leaves less than half of the power explained: nothing usable is there.
HOPELESS_MISFIT = 0.7
#: Distortion as large as the linear response itself.
HOPELESS_DISTORTION = 1.0
_EARLY_S = 0.0005
_ADVANCE_S = 0.02
_SIGNIFICANT = 5.0  # standard errors


@dataclass(frozen=True)
class Judgement:
    """What the fit leaves, output by output, and what follows from it.

    Attributes:
        verdict: 'linear' (standard errors hold, but for what is `unseen`) or 'doubtful'.
        warnings: why it is doubtful, for people; empty when linear.
        misfit: by output, rms relative to the response beyond noise (median over frequency), 0 to 1.
        distortion: by output, relative to the linear response; None where the input shows none.
        coherence: by output, median over frequency.
        unseen: where in the comfort band the outputs hardly answer the input, for people: no one knows there
            whether standard errors hold.
    """

    verdict: Trust
    warnings: tuple[str, ...]
    misfit: dict[str, float]
    distortion: dict[str, float] | None
    coherence: dict[str, float]
    unseen: tuple[str, ...] = ()


def judge(frf: FrequencyResponse, taken: Candidate) -> Judgement:
    """Judge the order that was taken by what it leaves.

    Raises:
        BadInputError: for every output the fit leaves more than half of the response's power, or distortion
            is as large as the response: there is no linear model in these data.
    """
    found = taken.fit
    misfit = dict(zip(frf.outputs, _misfit(frf, found), strict=True))
    distortion = _distortion(frf)
    coherence = {o: float(np.median(row)) for o, row in zip(frf.outputs, frf.coherence, strict=True)}
    _refuse_hopeless(misfit, distortion)
    warnings = []
    if worst := {o: m for o, m in misfit.items() if m > LARGEST_MISFIT}:
        warnings.append(
            f"the model misses the measured response by {_shares(worst)} beyond noise "
            f"({LARGEST_MISFIT:.0%} is allowed): the axle is not linear in these data, or the order is "
            "too low"
        )
    elif taken.excess > LARGEST_EXCESS:
        warnings.append(
            f"on frequencies left out of the fit the model is wrong by {share(taken.excess, 0)} rms beyond "
            f"noise ({LARGEST_EXCESS:.0%} is allowed): look at the figures where"
        )
    if distortion and (worst := {o: d for o, d in distortion.items() if d > LARGEST_DISTORTION}):
        warnings.append(
            f"nonlinear distortion reaches {_shares(worst)} of the linear response "
            f"({LARGEST_DISTORTION:.0%} is allowed): the model holds for this amplitude and input only"
        )
    repeats = frf.method.startswith("periodic")
    if not repeats and (worst := {o: c for o, c in coherence.items() if c < LEAST_COHERENCE}):
        warnings.append(
            f"the input explains only {_shares(worst)} of the output's power, and a record that does not "
            f"repeat cannot tell noise from nonlinearity: run a multisine, or excite harder"
        )
    early_s = _early(frf, found)
    if early_s > _EARLY_S:
        warnings.append(
            f"the outputs answer {early_s * 1e3:.3g} ms before the input acts: "
            "are channels swapped or not in step?"
        )
    verdict: Trust = "doubtful" if warnings else "linear"
    return Judgement(verdict, tuple(warnings), misfit, distortion, coherence, _unseen(frf))


def _unseen(frf: FrequencyResponse) -> tuple[str, ...]:
    """Sentences on coherence below `UNSEEN_COHERENCE` inside the band in which comfort is judged."""
    low_hz, high_hz = COMFORT_BAND_HZ
    inside = (frf.frequency_hz >= low_hz) & (frf.frequency_hz <= high_hz)
    if not inside.any():
        return ()
    low = check_coherence(
        frf.frequency_hz[inside],
        frf.coherence[:, inside],
        frf.outputs,
        least=UNSEEN_COHERENCE,
        allowed_share=1.0,
        where="",
    )
    if not low:
        return ()
    return (
        f"inside {low_hz:g}-{high_hz:g} Hz, where comfort is judged, more than the input moves the axle: "
        f"{'; '.join(low)}. Whether standard errors hold there is not known",
    )


def _refuse_hopeless(misfit: dict[str, float], distortion: dict[str, float] | None) -> None:
    fix = "find the cause first: `hil diagnose` identifies nonlinear effects; or excite at another amplitude"
    if min(misfit.values()) > HOPELESS_MISFIT:
        raise BadInputError(
            f"no linear model explains these data: the best fit misses the response by {_shares(misfit)}, "
            f"so it explains less than half of its power (a misfit up to {HOPELESS_MISFIT:.0%} is allowed)",
            fix=fix,
        )
    if distortion and min(distortion.values()) > HOPELESS_DISTORTION:
        raise BadInputError(
            f"no linear model explains these data: nonlinear distortion is {_shares(distortion)} of the "
            "linear response",
            fix=fix,
        )


def _shares(values: dict[str, float]) -> str:
    return ", ".join(f"{share(value, 0)} ({name})" for name, value in values.items())


def _misfit(frf: FrequencyResponse, found: Fit) -> list[float]:
    """Medians, so that the few frequencies without response (anti-resonances) do not decide."""
    size = np.maximum(np.abs(frf.response), 1e-300)
    error = np.abs(found.residual) * expected_deviation(frf) / size
    noise = frf.standard_deviation / size
    middle = np.median(np.minimum(error, 1.0), axis=1) ** 2 - np.median(np.minimum(noise, 1.0), axis=1) ** 2
    return [float(np.sqrt(max(m, 0.0))) for m in middle]


def _distortion(frf: FrequencyResponse) -> dict[str, float] | None:
    found = [0.0] * len(frf.outputs)
    seen = False
    if frf.distortion is not None and frf.distortion.share.size:
        seen, found = True, [float(v) for v in frf.distortion.share]
    if np.any(frf.nonlinear > 0):
        # Of the mean of M realisations; one alone, which is what acts, scatters sqrt(M) more.
        size = np.maximum(np.abs(frf.response), 1e-300)
        one = np.median(frf.nonlinear / size, axis=1) * np.sqrt(frf.realisations)
        seen, found = True, [max(a, float(b)) for a, b in zip(found, one, strict=True)]
    return dict(zip(frf.outputs, found, strict=True)) if seen else None


def _early(frf: FrequencyResponse, found: Fit) -> float:
    """By how much the outputs answer too early, s; 0 where they do not.

    A fit's dead time is never negative; so where it ended at zero the data are delayed and fitted again.
    """
    if found.modes.delay_s > 1e-6:
        return 0.0
    late = np.exp(-2j * np.pi * frf.frequency_hz * _ADVANCE_S)
    structure = found.modes.structure
    again = fit(replace(frf, response=frf.response * late), structure.order, integrator=structure.integrator)
    early = _ADVANCE_S - again.modes.delay_s
    sure = early > _SIGNIFICANT * again.delay_error_s and again.chi_square < found.chi_square
    return early if sure else 0.0
