"""Experiments in a controller's hands, and experiments that the dyno makes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tests.blind.experiments import Array, Experiment, MotorLoop, chirp, in_closed_loop, multisine, steps
from tests.blind.plant import COARSE, Truth, true_outputs

#: proportional on the motor speed, PI on it, PI and phase lead as in the paper, PI on the wheel speed
LOOPS = ("proportional", "pi", "paper", "wheel")

_LEAD_S, _LEAD_RATIO = 0.0078087, 0.25962  # 36 degrees at 40 Hz, (6) and (7) of the paper
_CLIPPED = 0.02  # share of samples at the limit from which a loop counts as unstable
_WEAKER, _TRIES = 0.6, 8


def closed_by(
    loop: str, experiments: list[Experiment], plant: Truth, rng: np.random.Generator
) -> list[Experiment]:
    """The same test signals beside the controller `loop`, which acts on a measured speed of `plant`.

    On the motor speed by (4) and (5) of the paper, with a pole of 0.2 to 0.6 rad/s, or as much as the
    plant bears.
    """
    if loop == "wheel":
        return [in_closed_loop(e, rng) for e in experiments]
    pole = rng.uniform(0.2, 0.6)
    moved = [in_closed_loop(e, rng) for e in experiments]
    for _ in range(_TRIES):
        closed = [replace(e, motor_loop=_motor_loop(loop, pole, plant, e)) for e in moved]
        if all(_holds(plant, e) for e in closed):
            return closed
        pole *= _WEAKER
    return closed


def _motor_loop(loop: str, pole_rad_s: float, plant: Truth, experiment: Experiment) -> MotorLoop:
    p = plant.parameters
    inertia = p["motor_inertia"] + p["vehicle_inertia"] / p["gear_ratio"] ** 2
    led = loop == "paper"
    return MotorLoop(
        2.0 * inertia * pole_rad_s,
        0.0 if loop == "proportional" else inertia * pole_rad_s**2,
        _LEAD_S if led else 0.0,
        _LEAD_RATIO if led else 1.0,
        2.0 * float(np.max(np.abs(experiment.torque_nm))) + 20.0,
    )


def _holds(plant: Truth, experiment: Experiment) -> bool:
    request, outputs = true_outputs(plant, experiment, substeps=COARSE)
    assert experiment.motor_loop is not None
    at_limit = np.abs(request) >= experiment.motor_loop.largest_nm
    return bool(np.all(np.isfinite(outputs)) and np.mean(at_limit) < _CLIPPED)


def by_the_dyno(experiments: list[Experiment], rng: np.random.Generator) -> list[Experiment]:
    """A chirp, steps and a multisine of the dyno's torque, each beside a fifth of an experiment's own torque.

    The load is in proportion to what the motor gives at the wheels.
    """
    chosen = [e for e in experiments if "chirp" in e.name or "multisine" in e.name or "steps" in e.name]
    made = []
    for number, experiment in enumerate(chosen):
        duration_s = experiment.duration_s
        largest = rng.uniform(150.0, 300.0)
        signal: Array = (
            chirp(0.5 * largest, 0.0, duration_s),
            steps(rng, largest, duration_s),
            multisine(rng, 0.3 * largest, duration_s),
        )[number % 3]
        signal = signal[: len(experiment.torque_nm)]
        made.append(replace(experiment, torque_nm=0.2 * experiment.torque_nm, load_nm=signal))
    return made
