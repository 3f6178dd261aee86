"""A turning mass with dry friction, gravity and a limited motor by formulas of its own, for tests.

Semi-implicit steps of 50 µs; at rest the mass stays where it is while the torque is below its friction.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
from numba import njit

from hil.core.model import Model
from hil.core.recording import Recording

_SAMPLE_S, _PARTS = 1e-3, 20


@njit(cache=True)
def _turn(torque, inertia, viscous, dry, gravity, peak, power, out):  # type: ignore[no-untyped-def]
    speed, angle = 0.0, 0.0
    h = _SAMPLE_S / _PARTS
    for k in range(len(torque)):
        out[k] = speed
        for _ in range(_PARTS):
            most = min(peak, power / max(abs(speed), 1e-9))
            drive = max(-most, min(torque[k], most)) - viscous * speed - gravity * np.sin(angle)
            if speed == 0.0 and abs(drive) <= dry:
                continue
            way = np.sign(speed) if speed != 0.0 else np.sign(drive)
            new = speed + h * (drive - dry * way) / inertia
            if speed * new < 0.0:
                new = 0.0
            speed = new
            angle += h * speed


def recording(
    inertia: float,
    viscous: float,
    dry: float = 0.0,
    gravity: float = 0.0,
    *,
    peak_nm: float = np.inf,
    power_w: float = np.inf,
    torque_nm: float = 20.0,
    noise_rad_s: float = 0.02,
    seconds: float = 30.0,
    seed: int = 0,
) -> Recording:
    """Random steps of torque with reversals, a small 3 Hz tone on them; speed with white noise at 1 kHz.

    Motor and inverter give what `peak_nm` and `power_w` allow of the torque at any moment.
    """
    rng = np.random.default_rng(seed)
    time = np.arange(round(seconds / _SAMPLE_S), dtype=np.float64) * _SAMPLE_S
    torque = np.zeros(len(time))
    at, way = 0.4, 1.0
    while at < seconds - 1.0:
        end = at + rng.uniform(0.5, 1.5)
        torque[round(at / _SAMPLE_S) : round(end / _SAMPLE_S)] = way * torque_nm * rng.uniform(0.2, 1.0)
        way = -way if rng.uniform() < 0.7 else way
        at = end
    torque += 0.1 * torque_nm * np.sin(2.0 * np.pi * 3.0 * time) * (time > 0.5)
    speed = np.empty(len(time))
    _turn(torque, inertia, viscous, dry, gravity, peak_nm, power_w, speed)
    shown: npt.NDArray[np.float64] = speed + rng.normal(0.0, noise_rad_s, len(time))
    channels = {"time_s": time, "motor_torque_ref_nm": torque, "motor_speed_rad_s": shown}
    return Recording(channels, Path(f"turning mass {seed}.csv"))


def base(inertia: float, drag: float = 0.0) -> Model:
    """A rigid model of that inertia and drag; a thousandth of it stands for a load."""
    parameters = {
        "motor_inertia": 0.999 * inertia,
        "gear_ratio": 1.0,
        "vehicle_inertia": 1e-3 * inertia,
        "viscous_drag": drag,
        "torque_delay": 0.0,
    }
    return Model("rigid", parameters)


def arm(seed: int, *, counts: int = 4096, seconds: float = 20.0) -> Recording:
    """An arm of 0.54 kg m², 1 N m s/rad, 0.3 N m of dry friction and 4 N m of gravity, led along a path.

    It turns less than once. Its position is read in counts, and a controller acts on them.
    """
    rng = np.random.default_rng(seed)
    time = np.arange(round(seconds / _SAMPLE_S), dtype=np.float64) * _SAMPLE_S
    path = np.zeros(len(time))
    for hz in (0.13, 0.31, 0.57, 1.1):
        path += rng.uniform(0.3, 1.2) * np.sin(2.0 * np.pi * hz * time + rng.uniform(0.0, 6.0))
    torque, angle = np.empty(len(time)), np.empty(len(time))
    _lead(path, 2.0 * np.pi / counts, torque, angle)
    channels = {"time_s": time, "motor_torque_ref_nm": torque, "motor_angle_rad": angle}
    return Recording(channels, Path(f"arm {seed}.csv"))


@njit(cache=True)
def _lead(path, count, torque, angle):  # type: ignore[no-untyped-def]
    speed, at, before, h = 0.0, 0.0, 0.0, _SAMPLE_S / _PARTS
    for k in range(len(path)):
        read = np.floor(at / count) * count
        asked = 60.0 * (path[k] - read) - 6.0 * (read - before) / _SAMPLE_S
        torque[k], angle[k] = min(max(asked, -30.0), 30.0), read
        before = read
        for _ in range(_PARTS):
            drive = torque[k] - speed - 4.0 * np.sin(at)
            if speed == 0.0 and abs(drive) <= 0.3:
                continue
            way = np.sign(speed) if speed != 0.0 else np.sign(drive)
            new = speed + h * (drive - 0.3 * way) / 0.54
            speed = 0.0 if speed * new < 0.0 else new
            at += h * speed
