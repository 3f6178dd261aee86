"""One short recording of an axle: enough to call a part of the diagnosis by itself."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from hil.analysis.missing_effects import Series, series_of
from hil.core.channels import INPUT, OUTPUTS, TIME
from hil.core.model import EffectUse, Model
from hil.core.recording import Recording
from hil.plant import simulate
from tests.hil.analysis.diagnosis.reference_plant import BASE

MODEL = Model("three_inertia", dict(BASE))
NOISE = (0.5, 0.05, 1.0)


def recorded(*effects: EffectUse, seconds: float = 4.0, seed: int = 1) -> Recording:
    """A chirp through the model with `effects`, white noise on every channel."""
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, seconds, 1e-3)
    torque = 20.0 * np.sin(2 * np.pi * (0.5 * time + 1.5 * time**2))
    channels = {TIME: time, INPUT: torque}
    clean = simulate(MODEL.with_effects(*effects), torque, 1e-3)
    for name, level in zip(OUTPUTS, NOISE, strict=True):
        channels[name] = clean[name] + rng.normal(0.0, level, len(time))
    return Recording(channels, Path("one.csv"))


def one_series(*effects: EffectUse, seconds: float = 4.0) -> Series:
    """The same, made ready."""
    return series_of(MODEL, [recorded(*effects, seconds=seconds)])[0]
