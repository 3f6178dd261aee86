"""A chirp through an axle with free play: slow enough to forget how it began, then fast enough to bounce."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from hil.analysis.diagnosis.data.noise import noise_levels
from hil.analysis.diagnosis.data.trace import trace_of
from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.problem import Problem, problem_of
from hil.core.channels import INPUT, OUTPUTS, TIME
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse
from hil.core.recording import Recording
from hil.plant import simulate
from tests.hil.analysis.diagnosis.one_recording import MODEL, NOISE

SECONDS, FROM_HZ, TO_HZ, TORQUE_NM = 16.0, 0.5, 20.0, 20.0


def with_play(half_gap_rad: float) -> Problem:
    """A logarithmic chirp of a torque that reverses, white noise on every channel."""
    rng = np.random.default_rng(1)
    time = np.arange(0.0, SECONDS, 1e-3)
    rise = np.log(TO_HZ / FROM_HZ) / SECONDS
    torque = TORQUE_NM * np.sin(2.0 * np.pi * FROM_HZ * np.expm1(rise * time) / rise)
    clean = simulate(MODEL.with_effects(play(half_gap_rad)), torque, 1e-3)
    channels = {TIME: time, INPUT: torque}
    for name, level in zip(OUTPUTS, NOISE, strict=True):
        channels[name] = clean[name] + rng.normal(0.0, level, len(time))
    trace = trace_of(Recording(channels, Path("chirp.csv")))
    return problem_of([trace], noise_levels([trace]), MODEL.parameters["gear_ratio"])


def play(half_gap_rad: float) -> EffectUse:
    """A free play with all numbers that an effect has."""
    return EffectUse("backlash", EFFECTS["backlash"].completed({"half_gap_rad": half_gap_rad}))


def supposed(half_gap_rad: float) -> Hypothesis:
    """The model with a play of that width."""
    return Hypothesis(MODEL).with_term(play(half_gap_rad))
