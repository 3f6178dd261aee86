"""From the torque request to the acting torque: dead time, dead band, lag, limits, fading."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit


@njit(error_model="numpy")
def delayed(ref: np.ndarray, start_s: float, end_s: float, sample_s: float) -> float:
    """Mean over [start_s, end_s] of the held request; the span is already shifted by the dead time.

    A first-in first-out buffer with a fractional part: where a new request falls inside the span, both
    count by their share. Nothing was asked before time zero.
    """
    first = math.floor(start_s / sample_s + 1e-9)
    last = math.floor(end_s / sample_s - 1e-9)
    early = ref[min(first, len(ref) - 1)] if first >= 0 else 0.0
    if last <= first:
        return early
    late = ref[min(last, len(ref) - 1)] if last >= 0 else 0.0
    share = (last * sample_s - start_s) / (end_s - start_s)
    return share * early + (1.0 - share) * late


@njit(error_model="numpy")
def acting(p: Any, request: float, lagged: float, before: float, time_s: float, step_s: float) -> Any:
    """One step of the path: (state of the lag, acting torque in N m).

    The lag is the exact discrete filter of a held input. Clipping comes after it, the slope limit last, so
    that the acting torque itself keeps both limits.
    """
    width = p.deadband_nm
    if request > width:
        asked = request - width
    elif request < -width:
        asked = request + width
    else:
        asked = 0.0
    asked *= p.torque_gain
    lagged = asked + (lagged - asked) * math.exp(-step_s / p.lag_s) if p.lag_s > 0.0 else asked
    torque = lagged * (1.0 - p.torque_fade * (1.0 - math.exp(-time_s / p.fade_time_s)))
    torque = min(max(torque, -p.limit_nm), p.limit_nm)
    most = p.rate_nm_s * step_s
    return lagged, min(max(torque, before - most), before + most)
