"""Many models for one torque, as fits of a diagnosis simulate them: time per sample, by law.

`python -m benchmarks.many_models`: twelve models of three inertias, 28 s at 1 kHz, on one thread and on all;
best of some turns. For the linear model python-control's `forced_response` beside it.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial

import control
import numpy as np
import numpy.typing as npt

from benchmarks.answers import largest_difference
from benchmarks.plant import best_of
from hil.core.model import EffectUse, Model, load_model
from hil.core.runtime.thread_map import threads
from hil.engine.bench.bench_file import shipped
from hil.plant import ideal_sensors, linear_system, pack, simulate_many

Array = npt.NDArray[np.float64]

MODELS, SAMPLES, DT, TURNS = 12, 28_000, 1e-3, 15
BLOCK = 4  # samples, of which the mean is compared
SAME = 1e-6  # rad/s and N m, of up to 2,500 N m
LAWS: Mapping[str, tuple[EffectUse, ...]] = {
    "linear": (),
    "dry friction": (EffectUse("coulomb_friction", {"torque_nm": 1.5}),),
    "cubic stiffness": (EffectUse("shaft_cubic_stiffness", {"coefficient_nm_rad3": 1e4}),),
    "play": (EffectUse("backlash", {"half_gap_rad": 0.02}),),
    "play, damped flanks": (
        EffectUse(
            "backlash", {"half_gap_rad": 0.02, "contact_damping_nms_rad": 30.0, "contact_depth_rad": 5e-4}
        ),
    ),
    "hysteresis": (EffectUse("shaft_hysteresis", {"stiffness_nm_rad": 500.0, "slip_rad": 0.004}),),
    "ripple": (EffectUse("motor_order_ripple", {"order": 6.0, "amplitude_nm": 2.0, "phase_rad": 0.3}),),
}


def main() -> None:
    if threads() > 1:  # they are counted once for a process
        one = {**os.environ, "NUMBA_NUM_THREADS": "1"}
        subprocess.run([sys.executable, "-m", "benchmarks.many_models"], env=one, check=True)
    print(f"{MODELS} models, {SAMPLES} samples, threads: {threads()}; ns for each sample of a model")
    model = load_model(shipped("three_inertia.toml"))
    time_s = np.arange(SAMPLES) * DT
    torque = 30 + 120 * np.sin(np.pi * (1.0 + 0.5 * time_s) * time_s) * np.sin(0.8 * time_s)
    runs: dict[str, Callable[[], object]] = {
        name: simulated(replace(model, effects=effects), torque) for name, effects in LAWS.items()
    }
    turned = np.cumsum(80.0 + 40.0 * np.sin(time_s)) * DT
    angles = np.column_stack([turned / model.parameters["gear_ratio"], turned])
    runs["ripple, measured angle"] = simulated(replace(model, effects=LAWS["ripple"]), torque, angles)
    for name, run in runs.items():
        print(f"  {name:24}{best_of(run, TURNS) / (MODELS * SAMPLES) * 1e6:8.1f}")
    alone = best_of(by_control(replace(model, effects=()), torque))
    print(f"  {'linear, python-control':24}{alone / SAMPLES * 1e6:8.1f}")


def by_control(model: Model, torque: Array) -> Callable[[], object]:
    """One linear model by python-control, the torque held; its outputs are those of the kernel.

    Raises:
        OtherAnswerError: they are not.
    """
    system = linear_system(model)
    continuous = control.ss(system.a, system.b[:, :1], system.c, system.d[:, :1])
    held = control.c2d(continuous, DT, "zoh")
    late = np.concatenate([np.full(round(system.delay_s / DT), torque[0]), torque])[:SAMPLES]
    time_s = np.arange(SAMPLES) * DT
    run = partial(control.forced_response, held, time_s, late)
    outputs = run().outputs.T.reshape(-1, BLOCK, 3).mean(axis=1)
    largest_difference("python-control", simulated(model, torque)()[0], outputs, SAME)
    return run


def simulated(model: Model, torque: Array, angles: Array | None = None) -> Callable[[], Array]:
    """A run of models that differ a little; `angles` are what ripples follow, their own if None."""
    parameters = np.repeat(np.array(pack(model))[None], MODELS, 0)
    parameters[:, 0] *= 1.0 + 1e-3 * np.arange(MODELS)
    starts, sensors = np.zeros((MODELS, 3)), ideal_sensors(MODELS)
    return lambda: simulate_many(parameters, torque, DT, starts, sensors, BLOCK, angles)


if __name__ == "__main__":
    main()
