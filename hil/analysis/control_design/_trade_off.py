"""Phase at the resonance against the sensitivity peak, over lead angle and lead frequency (Fig. 10)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.analysis.control_design._laws import Normalisation, lead, lead_function
from hil.analysis.control_design._loop import encirclements, feedback_response

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

LEAD_ANGLES_DEG = tuple(float(a) for a in range(0, 65, 6))
LEAD_FREQUENCIES_HZ = (15.0, 20.0, 30.0, 40.0, 60.0, 80.0)


@dataclass(frozen=True)
class TradeOff:
    """One value for each lead angle (A) and lead frequency (B).

    `phase_deg` is the open loop's phase at the resonance, `sensitivity_peak` the largest |S| and
    `resonance_sensitivity` |S| at the resonance (A x B); both are NaN where the loop is unstable.
    """

    angles_deg: Array
    frequencies_hz: Array
    phase_deg: Array
    sensitivity_peak: Array
    resonance_sensitivity: Array


def trade_off(
    frequency_hz: Array,
    pi_loop: ComplexArray,
    resonance_hz: float,
    normalisation: Normalisation,
    sample_time_s: float | None,
    *,
    origin_poles: int = 2,
) -> TradeOff:
    """Evaluate every lead on the open loop with PI control.

    Args:
        frequency_hz: F frequencies of a dense grid.
        pi_loop: F values of the open loop with the PI controller alone.
        resonance_hz: where the phase is read.
        normalisation: the lead's.
        sample_time_s: Tustin's rule at this sample time; None for continuous.
        origin_poles: poles of the open loop at the origin.
    """
    shape = (len(LEAD_ANGLES_DEG), len(LEAD_FREQUENCIES_HZ))
    phase, peak, at_resonance = np.empty(shape), np.empty(shape), np.empty(shape)
    for a, angle in enumerate(LEAD_ANGLES_DEG):
        for b, centre in enumerate(LEAD_FREQUENCIES_HZ):
            part = lead_function(lead(angle, centre, normalisation))
            loop = pi_loop * feedback_response((part,), frequency_hz, sample_time_s)
            sensitivity = 1 / np.maximum(np.abs(1 + loop), 1e-300)
            stable = encirclements(loop, origin_poles) == 0
            here = np.interp(resonance_hz, frequency_hz, loop)
            phase[a, b] = np.degrees(np.angle(here))
            peak[a, b] = np.max(sensitivity) if stable else np.nan
            at_resonance[a, b] = 1 / abs(1 + here) if stable else np.nan
    return TradeOff(np.array(LEAD_ANGLES_DEG), np.array(LEAD_FREQUENCIES_HZ), phase, peak, at_resonance)
