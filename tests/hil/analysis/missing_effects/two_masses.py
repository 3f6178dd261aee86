"""Two masses on a shaft, the second one braked by dry and viscous friction, by formulas of its own.

Semi-implicit steps of 50 µs; the second mass rests while what pulls it is below its dry friction.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numba import njit

from hil.core.model import Model
from hil.core.recording import Recording

NUMBERS = {
    "motor_inertia": 0.09,
    "gear_ratio": 1.0,
    "shaft_stiffness": 33.0,
    "shaft_damping": 0.2,
    "vehicle_inertia": 0.15,
    "torque_delay": 0.0,
}
_SAMPLE_S, _PARTS = 1e-3, 20


@njit(cache=True)
def _turn(torque, numbers, dry, viscous, out):  # type: ignore[no-untyped-def]
    motor_inertia, stiffness, damping, load_inertia = numbers
    motor, load, twist = 0.0, 0.0, 0.0
    h = _SAMPLE_S / _PARTS
    for k in range(len(torque)):
        out[k, 0], out[k, 1] = motor, load
        for _ in range(_PARTS):
            shaft = stiffness * twist + damping * (motor - load)
            motor += h * (torque[k] - shaft) / motor_inertia
            pull = shaft - viscous * load
            if load != 0.0 or abs(pull) > dry:
                way = np.sign(load) if load != 0.0 else np.sign(pull)
                new = load + h * (pull - dry * way) / load_inertia
                load = 0.0 if load * new < 0.0 else new
            twist += h * (motor - load)


def braked(dry_nm: float, viscous_nms_rad: float) -> Recording:
    """Speeds of both masses under torque that changes every 0.4 s at random, for 30 s, 0.5 % noise."""
    rng = np.random.default_rng(0)
    count = round(30.0 / _SAMPLE_S)
    torque = np.repeat(rng.uniform(-4.0, 4.0, count // 400), 400)
    out = np.empty((count, 2))
    numbers = [NUMBERS[n] for n in ("motor_inertia", "shaft_stiffness", "shaft_damping", "vehicle_inertia")]
    _turn(torque, np.array(numbers), dry_nm, viscous_nms_rad, out)
    out += 0.005 * np.std(out, axis=0) * rng.normal(size=out.shape)
    time = np.arange(count, dtype=np.float64) * _SAMPLE_S
    shown = {"motor_speed_rad_s": out[:, 0].copy(), "wheel_speed_rad_s": out[:, 1].copy()}
    return Recording({"time_s": time, "motor_torque_ref_nm": torque} | shown, Path("braked.csv"))


def base() -> Model:
    """The two masses without what brakes them."""
    return Model("two_inertia", NUMBERS)
