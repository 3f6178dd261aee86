"""A torque request that was read too seldom to be known between its samples."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from hil.analysis.diagnosis.data.thresholds import STEPPED
from hil.analysis.diagnosis.data.trace import Trace


def smooth(trace: Trace) -> Trace:
    """`trace` with a request that was smooth between its samples, and not held from one to the next.

    A held request comes half a sample late, and weaker the faster it changes, by sin(x)/x with x = pi f dt.
    Where that is taken back beforehand, what is simulated with held samples is what the smooth one does.
    """
    torque = trace.torque
    ends = np.linspace(torque[0], torque[-1], len(torque))
    odd = torque - ends
    around = np.concatenate([odd, -odd[-2:0:-1]])  # goes on evenly beyond both ends
    f = np.fft.rfftfreq(len(around), trace.dt) * trace.dt
    early = np.fft.irfft(np.fft.rfft(around) * np.exp(1j * np.pi * f) / np.sinc(f), len(around))
    slope = 0.5 * (torque[-1] - torque[0]) / (len(torque) - 1)
    return replace(trace, torque=np.ascontiguousarray(early[: len(torque)] + ends + slope))


def is_stepped(trace: Trace) -> bool:
    """Whether the request changes by far most in few places."""
    changes = np.abs(np.diff(trace.torque))
    return bool(np.median(changes) <= STEPPED * np.sqrt(np.mean(changes**2)))
