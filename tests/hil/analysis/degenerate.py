"""Recordings that no bench should make, by name and seed: what analyses must survive."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from hil.core.channels import INPUT, OUTPUTS, TIME
from hil.core.model import load_model
from hil.core.recording import Recording
from hil.plant import simulate
from tests.benches_for_tests import SIM

MODEL = load_model(SIM.simulation.model).with_effects()
Channels = dict[str, np.ndarray]
Change = Callable[[Channels, np.random.Generator], Channels]


def good(count: int = 4000, step_s: float = 1e-3, seed: int = 0) -> Channels:
    """A chirp on the shipped axle with some noise."""
    time = np.arange(count) * step_s
    end = max(float(time[-1]), step_s)
    torque = 30 * np.sin(2 * np.pi * (0.5 * time + 0.5 * min(20.0, 0.2 / step_s) / end * time**2))
    clean = simulate(MODEL, torque, step_s)
    rng = np.random.default_rng(seed)
    noisy = {
        n: clean[n] + 0.01 * max(float(np.std(clean[n])), 1e-6) * rng.standard_normal(count) for n in OUTPUTS
    }
    return {TIME: time, INPUT: torque, **noisy}


def _each(change: Callable[[np.ndarray], np.ndarray], *names: str) -> Change:
    def changed(c: Channels, rng: np.random.Generator) -> Channels:
        del rng
        return {n: change(v) if n in names else v for n, v in c.items()}

    return changed


def _only(*names: str) -> Change:
    return lambda c, rng: {n: c[n] for n in (TIME, INPUT, *names)}


def _noise(c: Channels, rng: np.random.Generator) -> Channels:
    return {n: v if n == TIME else rng.standard_normal(len(v)) for n, v in c.items()}


def _one_cell(value: float, name: str) -> Change:
    def changed(c: Channels, rng: np.random.Generator) -> Channels:
        cell = c[name].copy()
        cell[int(rng.integers(len(cell)))] = value
        return {**c, name: cell}

    return changed


def _same(c: Channels, rng: np.random.Generator) -> Channels:
    del rng
    return {n: v if n == TIME else c[INPUT] for n, v in c.items()}


def _step(c: Channels, rng: np.random.Generator) -> Channels:
    del rng
    count = len(c[TIME])
    torque = np.where(np.arange(count) < count // 3, 0.0, 20.0)
    step_s = float(c[TIME][1])
    clean = simulate(MODEL, torque, step_s)
    return {TIME: c[TIME], INPUT: torque, **{n: clean[n] for n in OUTPUTS}}


ALL = (INPUT, *OUTPUTS)
CHANGES: dict[str, Change] = {
    "as it should be": lambda c, rng: c,
    **{f"constant {n}": _each(lambda v: np.full(len(v), 3.0), n) for n in ALL},
    **{f"zero {n}": _each(np.zeros_like, n) for n in ALL},
    "constant outputs": _each(lambda v: np.full(len(v), 3.0), *OUTPUTS),
    "all zero": _each(np.zeros_like, *ALL),
    "all constant": _each(lambda v: np.full(len(v), -7.5), *ALL),
    **{f"only {n}": _only(n) for n in OUTPUTS},
    "step only": _step,
    "noise": _noise,
    "all equal": _same,
    "speeds doubled": lambda c, rng: {**c, OUTPUTS[1]: c[OUTPUTS[0]]},
    "huge": _each(lambda v: v * 1e300, *OUTPUTS),
    "huge torque": _each(lambda v: v * 1e300, INPUT),
    "very large": _each(lambda v: v * 1e100, *ALL),
    "tiny": _each(lambda v: v * 1e-300, *ALL),
    "tiny torque": _each(lambda v: v * 1e-300, INPUT),
    "subnormal": _each(lambda v: v * 1e-320, *OUTPUTS),
    **{f"one cell of 1e308 in {n}": _one_cell(1e308, n) for n in ALL},
    **{f"one cell of -1e200 in {n}": _one_cell(-1e200, n) for n in ALL},
    "inverted": _each(np.negative, *OUTPUTS),
    "levels": _each(lambda v: np.sign(v), *ALL),
    "late start": _each(lambda v: v + 1e9, TIME),
    "early start": _each(lambda v: v - 1e9, TIME),
    "rounded time": _each(lambda v: v + 1e12, TIME),
    "jitter": lambda c, rng: {**c, TIME: c[TIME] + rng.uniform(-0.4, 0.4, len(c[TIME])) * c[TIME][1]},
    "a gap": lambda c, rng: {n: np.delete(v, slice(len(v) // 3, len(v) // 2)) for n, v in c.items()},
    "ramp": _each(lambda v: np.linspace(0, 1, len(v)), *ALL),
    "one spike": _each(lambda v: np.eye(1, len(v), len(v) // 2)[0], *ALL),
}
SHAPES = {
    "4000 samples": (4000, 1e-3),
    "200 samples": (200, 1e-3),
    "201 samples": (201, 1e-3),
    "199 samples": (199, 1e-3),
    "3 samples": (3, 1e-3),
    "every 0.1 s": (600, 0.1),
    "every 20 ms": (600, 0.02),
    "every 10 us": (4000, 1e-5),
}


def recording(change: str, shape: str = "4000 samples", seed: int = 0) -> Recording:
    """One of them; infinite values that a change made are as large as floats go."""
    count, step_s = SHAPES[shape]
    made = CHANGES[change](good(count, step_s, seed), np.random.default_rng(seed))
    finite = {n: np.nan_to_num(np.asarray(v, dtype=float)) for n, v in made.items()}
    return Recording(finite, Path(f"{change}, {shape}.csv"))
