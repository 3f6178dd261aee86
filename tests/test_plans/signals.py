"""Recordings with known answers."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from hil.core.recording import Recording
from hil.core.result import Segment
from test_plans import Array

SAMPLE_TIME_S = 0.001
STEP = Segment(id="up", start_s=2.0, step_s=3.0, end_s=23.0, reference_before=0.0, reference_after=326.0)


def time_axis(end_s: float = 25.0, sample_time_s: float = SAMPLE_TIME_S) -> Array:
    return np.arange(round(end_s / sample_time_s) + 1, dtype=float) * sample_time_s


def recording_of(time_s: Array, **channels: Array) -> Recording:
    return Recording({"time_s": time_s, **channels}, Path("made.mcap"))


def second_order_step(time_s: Array, size: float, damping: float, frequency_rad_s: float) -> Array:
    """Response of ω²/(s² + 2ζωs + ω²) to a step of `size` at STEP.step_s; underdamped."""
    t = np.maximum(time_s - STEP.step_s, 0.0)
    root = np.sqrt(1 - damping**2)
    damped = frequency_rad_s * root
    ringing = np.cos(damped * t) + damping / root * np.sin(damped * t)
    return np.asarray(size * (1 - np.exp(-damping * frequency_rad_s * t) * ringing))
