"""The plant kernel against the same equations in C, and against scipy and python-control."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import control
import numpy as np
from scipy.integrate import solve_ivp

from benchmarks.answers import largest_difference
from benchmarks.c_plant import compiled_c, refuse_more
from hil.core.model import Model, load_model
from hil.engine.bench.bench_file import shipped
from hil.plant import kernel, slots

SAMPLES, DT, STEP = 20_000, 1e-3, 1e-4
#: How far rotor speeds of some 300 rad/s may differ where both computed the same, rad/s. In C sums are
#: taken in another order; scipy steps as it likes, within its tolerance of 0.001.
SAME, SCIPY_SAME = 1e-6, 0.1


def best_of(run: Callable[[], object], times: int = 5) -> float:
    """Shortest of several runs in milliseconds."""
    durations = []
    for _ in range(times):
        start = time.perf_counter()
        run()
        durations.append(time.perf_counter() - start)
    return min(durations) * 1e3


def matrices(model: Model) -> tuple[np.ndarray, np.ndarray]:
    """A and B of the linear three-inertia chain."""
    p = model.parameters
    j, n, k, d = p["motor_inertia"], p["gear_ratio"], p["shaft_stiffness"], p["shaft_damping"]
    jw, jv, kt, dt = p["wheel_inertia"], p["vehicle_inertia"], p["tyre_stiffness"], p["tyre_damping"]
    a = np.array(
        [
            [-d / (j * n * n), -k / (j * n), d / (j * n), 0, 0],
            [1 / n, 0, -1, 0, 0],
            [d / (jw * n), k / jw, -(d + dt) / jw, -kt / jw, dt / jw],
            [0, 0, 1, 0, -1],
            [0, 0, dt / jv, kt / jv, -dt / jv],
        ]
    )
    return a, np.array([1 / j, 0, 0, 0, 0])


def against_others(model: Model, torque: np.ndarray) -> list[tuple[str, float, np.ndarray, float]]:
    """scipy's solve_ivp with the torque held, and python-control's forced_response, dead time left out.

    Each with its time in ms, its rotor speed, and how far that may differ from the kernel's.
    """
    a, b = matrices(model)
    found: list[tuple[str, float, np.ndarray, float]] = []

    def by_scipy() -> np.ndarray:
        answer = solve_ivp(
            lambda t, x: a @ x + b * torque[min(int(t / DT), SAMPLES - 1)],
            (0, (SAMPLES - 1) * DT),
            np.zeros(5),
            t_eval=np.arange(SAMPLES) * DT,
            max_step=DT,
        )
        return np.asarray(answer.y[0])

    system = control.c2d(control.ss(a, b[:, None], np.eye(5), np.zeros((5, 1))), DT, "zoh")

    def by_control() -> np.ndarray:
        return np.asarray(control.forced_response(system, np.arange(SAMPLES) * DT, torque)[1][0])

    for name, run, allowed in (
        ("scipy solve_ivp", by_scipy, SCIPY_SAME),
        ("python-control, exact discretisation", by_control, SAME),
    ):
        start = time.perf_counter()
        result = run()
        found.append((name, (time.perf_counter() - start) * 1e3, result, allowed))
    return found


def main() -> None:
    torque = np.zeros(SAMPLES)
    torque[1000:] = 40.0
    load = np.zeros(SAMPLES)
    with_order = load_model(shipped("three_inertia.toml"))
    linear = with_order.with_effects().with_parameters(torque_delay=0.0)
    print(f"{SAMPLES * DT:.0f} s at {DT * 1e3:g} ms samples, Runge-Kutta steps of {STEP * 1e3:g} ms")
    print(f"{'':42}{'ms':>9}{'of C':>8}{'largest difference of ω_m':>28}")
    with tempfile.TemporaryDirectory() as directory:
        run_c = compiled_c(Path(directory), DT, STEP)
        for title, model in (("three inertias", linear), ("default bench (wheel order)", with_order)):
            vector = slots.pack(model)
            refuse_more(vector)
            rest = np.zeros(kernel.START_COLUMNS)
            out_c, out = kernel.empty_output(SAMPLES), kernel.empty_output(SAMPLES)
            kernel.run(torque, load, True, DT, vector, rest, STEP, out)  # compiles
            c_ms = best_of(partial(run_c, torque, vector, out_c))
            ms = best_of(partial(kernel.run, torque, load, True, DT, vector, rest, STEP, out))
            for column in range(kernel.OUTPUT_COLUMNS):
                largest_difference(f"C, column {column}", out[:, column], out_c[:, column], 1e-4)
            difference = largest_difference("C -O3", out[:, 0], out_c[:, 0], SAME)
            print(f"{title + ', C -O3':42}{c_ms:9.2f}{1.0:8.2f}")
            print(f"{title + ', kernel':42}{ms:9.2f}{ms / c_ms:8.2f}{difference:28.2e}")
            if model is linear:
                for name, other_ms, speed, allowed in against_others(model, torque):
                    difference = largest_difference(name, out[:, 0], speed, allowed)
                    print(f"{name:42}{other_ms:9.2f}{other_ms / c_ms:8.1f}{difference:28.2e}")


if __name__ == "__main__":
    main()
