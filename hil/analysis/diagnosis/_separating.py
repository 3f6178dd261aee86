"""The test that tells two effects apart: plans simulated with both, the one that differs most is written."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import yaml

from hil.core.channels import OUTPUTS
from hil.core.model import Model
from sim_backend.plant import Start, simulate

Array = npt.NDArray[np.float64]

_DT = 1e-3
_SHORT_S = 20.0
_NAMES = {
    "chirp_large": "chirp of large amplitude",
    "chirp_small": "chirp of small amplitude",
    "chirp_biased": "chirp around a bias that never reverses",
    "stairs": "torque stairs through zero",
    "coast": "coast-down",
}


def separating_plan(
    one: Model, other: Model, noise: Array, torque_nm: float, names: tuple[str, str]
) -> tuple[str, str]:
    """Text in words, and a plan file, of the stimulus at which two models differ most against the noise.

    Args:
        noise: standard deviation of each output per sample, shape (3,).
        torque_nm: largest torque request to use, N m; the recordings' own, so within the bench's limits.
        names: ids of the two effects.
    """
    best, most = "chirp_large", -1.0
    for name, (torque, speed) in _stimuli(torque_nm).items():
        start = Start(speed * one.parameters["gear_ratio"], speed, 0.0)
        a, b = simulate(one, torque, _DT, start), simulate(other, torque, _DT, start)
        difference = sum(
            float(np.sum(((a[c] - b[c]) / noise[i]) ** 2))
            for i, c in enumerate(OUTPUTS)
            if np.isfinite(noise[i])
        )
        if difference / len(torque) > most:
            best, most = name, difference / len(torque)
    words = (
        f"{_NAMES[best]}, up to {torque_nm:.0f} N m: the two differ by {np.sqrt(most):.1f} noise levels rms"
    )
    return words, _plan(best, torque_nm, names)


def _stimuli(torque: float) -> dict[str, tuple[Array, float]]:
    t = np.arange(round(_SHORT_S / _DT)) * _DT
    growth = np.log(300.0) / _SHORT_S
    wave = np.sin(2 * np.pi * 0.1 / growth * np.expm1(growth * t))
    levels = np.array([0.0, 0.5, -0.5, 0.1, -0.1, 1.0, -1.0, 0.0])
    return {
        "chirp_large": (torque * wave, 10.0),
        "chirp_small": (0.2 * torque * wave, 10.0),
        "chirp_biased": (torque * (0.6 + 0.35 * wave), 5.0),
        "stairs": (torque * levels[np.minimum((t / 2.5).astype(int), 7)], 0.0),
        "coast": (np.zeros(len(t)), 30.0),
    }


def _plan(best: str, torque: float, names: tuple[str, str]) -> str:
    amplitude = round(torque, 2)
    chirp: dict[str, Any] = {
        "segment": best,
        "quantity": "motor_torque",
        "from_hz": 0.1,
        "to_hz": 30,
        "duration_s": 60,
    }
    steps: dict[str, list[dict[str, Any]]] = {
        "chirp_large": [
            {"hold_speed": {"speed_km_h": 12, "duration_s": 2}},
            {"chirp": {**chirp, "amplitude_nm": amplitude}},
        ],
        "chirp_small": [
            {"hold_speed": {"speed_km_h": 12, "duration_s": 2}},
            {"chirp": {**chirp, "amplitude_nm": round(0.2 * amplitude, 2)}},
        ],
        "chirp_biased": [
            {"hold_speed": {"speed_km_h": 6, "duration_s": 2}},
            {
                "chirp": {
                    **chirp,
                    "amplitude_nm": round(0.35 * amplitude, 2),
                    "bias_nm": round(0.6 * amplitude, 2),
                }
            },
        ],
        "stairs": [
            {
                "stairs": {
                    "segment": "stairs",
                    "quantity": "motor_torque",
                    "levels_nm": [round(s * amplitude, 2) for s in (0, 0.5, -0.5, 0.1, -0.1, 1, -1, 0)],
                    "hold_s": 2.5,
                }
            }
        ],
        "coast": [
            {"hold_speed": {"speed_km_h": 40, "duration_s": 3}},
            {"coast": {"duration_s": 30}},
        ],
    }
    plan = {
        "name": f"separate_{names[0]}_{names[1]}",
        "title": f"Test that tells {names[0]} from {names[1]}",
        "steps": steps[best],
        "finally": [{"ramp_down": {"duration_s": 4}}],
    }
    return str(yaml.safe_dump(plan, sort_keys=False))
