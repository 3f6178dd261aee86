"""Data for the diagnosis' tests: a driveline written anew, with other formulas than the product's plant.

Semi-implicit steps of 0.1 ms; LuGre friction, Hunt-Crossley contact, Bouc-Wen or a Jenkins element,
saturation and slew limit at the sample. Shares no code with the plant of the product.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numba import njit

from hil.core.recording import Recording

BASE = {
    "motor_inertia": 0.0200,
    "gear_ratio": 8.148,
    "shaft_stiffness": 6089.0,
    "shaft_damping": 19.75,
    "wheel_inertia": 4.355,
    "tyre_stiffness": 5717.0,
    "tyre_damping": 351.0,
    "vehicle_inertia": 303.0,
    "torque_delay": 0.008,
}
CHANNELS = ("motor_speed_rad_s", "wheel_speed_rad_s", "shaft_torque_nm")
_KEYS = [
    "motor_inertia",
    "gear_ratio",
    "shaft_stiffness",
    "shaft_damping",
    "wheel_inertia",
    "tyre_stiffness",
    "tyre_damping",
    "vehicle_inertia",
    "torque_delay",
    "lag",
    "gap",
    "cubic",
    "hyst_k",
    "hyst_slip",
    "coulomb",
    "stribeck",
    "friction_offset",
    "drag",
    "mount_j",
    "mount_k",
    "mount_c",
    "w_order",
    "w_amp",
    "w_phase",
    "m_order",
    "m_amp",
    "m_phase",
    "rolling",
    "aero",
    "rigid_tyre",
    "bouc_wen",
    "slip_coefficient",
    "torque_line_hz",
    "torque_line_nm",
    "drift",
]
_I = {name: index for index, name in enumerate(_KEYS)}


@njit(cache=True)
def _integrate(torque, dt, p, start, out):
    jm, n, ks, cs, jw, kt, ct, jv = p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7]
    delay, lag, gap, cubic, hk, hs, fc, fs, fo, drag = (
        p[8],
        p[9],
        p[10],
        p[11],
        p[12],
        p[13],
        p[14],
        p[15],
        p[16],
        p[17],
    )
    mj, mk, mc = p[18], p[19], p[20]
    sub = 40
    h = dt / sub
    wm, ww, wv = start[0], start[1], start[1]
    e, et, ha, hw, zf, zh, tl = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, torque[0]
    aw, am = 0.0, 0.0
    sigma = 4e4 * jm
    for k in range(torque.shape[0]):
        stiffness = ks * (1.0 - p[34] * k / torque.shape[0])
        for s in range(sub):
            t = (k + s / sub) * dt - delay
            i = math.floor(t / dt + 1e-9)
            u = torque[max(i, 0)]
            if p[33] != 0.0:
                u += p[33] * math.sin(2 * math.pi * p[32] * (k + s / sub) * dt)
            if lag > 0.0:
                tl += (u - tl) * (1.0 - math.exp(-h / lag))
                u = tl
            v = hw + (wm - hw) / n - ww
            if gap > 0.0:
                if e > gap:
                    d = e - gap
                    ts = max(0.0, stiffness * d + cs * v * min(1.0, d / 0.0005))
                elif e < -gap:
                    d = e + gap
                    ts = min(0.0, stiffness * d + cs * v * min(1.0, -d / 0.0005))
                else:
                    ts = 0.0
                    d = 0.0
            else:
                ts = stiffness * e + cs * v
                d = e
            ts += cubic * d * d * d
            if hk > 0.0:
                if p[30] > 0.5:
                    zh += h * (v - 0.5 / hs * abs(v) * zh - 0.5 / hs * v * abs(zh))
                else:
                    zh = min(max(zh + h * v, -hs), hs)
                ts += hk * zh
            if p[22] != 0.0:
                ts += p[22] * math.sin(p[21] * aw + p[23])
            if s == 0:
                out[k, 0], out[k, 1], out[k, 2] = wm - hw, ww, ts
            rel = wm - hw
            loss = drag * rel + fo
            if fc > 0.0 or fs > 0.0:
                g = fc + fs * math.exp(-((rel / 1.5) ** 2))
                if abs(rel) > 1e-12:
                    ss = g / sigma * math.copysign(1.0, rel)
                    a = math.exp(-sigma * abs(rel) * h / g)
                    new = ss + (zf - ss) * a
                else:
                    new = zf
                rate = (new - zf) / h
                zf = new
                loss += sigma * zf + 1.2 * math.sqrt(sigma * jm) * rate
            if p[25] != 0.0:
                loss -= p[25] * math.sin(p[24] * am + p[26])
            tyre = kt * et + ct * (ww - wv)
            if p[31] > 0.0:
                rise = tyre / p[31]
                tyre = p[31] * math.tanh(rise)
            if mj > 0.0:
                hw += h * (loss - u + ts / n - ts - mk * ha - mc * hw) / mj
                ha += h * hw
            wm += h * (u - loss - ts / n) / jm
            load = 0.0
            at = wv if p[29] == 0.0 else ww
            if p[27] != 0.0 or p[28] != 0.0:
                load = p[27] * min(max(at / 0.02, -1.0), 1.0) + p[28] * at * abs(at)
            if p[29] == 0.0:
                ww += h * (ts - tyre) / jw
                wv += h * (tyre - load) / jv
                et += h * (ww - wv)
            else:
                ww += h * (ts - load) / jv
                wv = ww
            e += h * (hw + (wm - hw) / n - ww)
            aw += h * ww
            am += h * (wm - hw)


@dataclass
class Truth:
    """What is hidden in the data: plant numbers beside the base ones, and what sensors do."""

    plant: dict[str, float] = field(default_factory=dict)
    saturation: float = math.inf
    rate_limit: float = math.inf
    deadband: float = 0.0
    gain: dict[str, float] = field(default_factory=dict)
    offset: dict[str, float] = field(default_factory=dict)
    skew: dict[str, float] = field(default_factory=dict)
    step: dict[str, float] = field(default_factory=dict)
    two_inertia: bool = False


def torques(rng: np.random.Generator, short: bool = False) -> dict[str, tuple[np.ndarray, float]]:
    """Torque requests (N m, 1 kHz) with the wheel speed (rad/s) that each begins at."""
    scale = rng.uniform(0.8, 1.3)

    def time(duration: float) -> np.ndarray:
        return np.arange(round(duration * 1000)) * 1e-3

    def chirp(duration: float, amplitude: float, bias: float = 0.0) -> np.ndarray:
        t = time(duration)
        growth = math.log(30 / 0.1) / duration
        fade = np.minimum(1.0, np.minimum(t, duration - t) / 0.5)
        return fade * (bias + amplitude * np.sin(2 * math.pi * 0.1 / growth * np.expm1(growth * t)))

    share = 0.4 if short else 1.0
    t = time(30 * share)
    lines = np.arange(1, 150) / 10
    multi = sum(np.sin(2 * math.pi * f * t + rng.uniform(0, 6.28)) for f in lines)
    t = time(20 * share)
    stairs = np.array([0, 20, 0, -15, 40, 0, 30, -30, 10, 0])[np.minimum((t / (2 * share)).astype(int), 9)]
    t = time(24 * share)
    reversals = np.sign(np.sin(2 * math.pi * 0.5 * t)) * (5 + 25 * t / t[-1])
    coast = np.where(time(20 * share) < 1.0, 5.0, 0.0)
    return {
        "chirp_high": (scale * chirp(40 * share, 30.0), 0.0),
        "chirp_low": (scale * chirp(36 * share, 10.0), 15.0),
        "chirp_biased": (scale * chirp(26 * share, 8.0, 15.0), 5.0),
        "steps": (scale * stairs.astype(float), 0.0),
        "multisine": (scale * multi * 12.0 / np.std(multi), 10.0),
        "reversals": (scale * reversals, 0.0),
        "coast": (scale * coast, 30.0),
    }


def recordings(
    truth: Truth,
    seed: int = 0,
    *,
    noise: tuple[float, float, float] = (0.15, 0.02, 1.5),
    off: float = 0.01,
    short: bool = False,
    only: tuple[str, ...] = (),
) -> list[Recording]:
    """Noisy recordings of the hidden truth; base parameters are off by an sd of `off`, at most 2 %."""
    rng = np.random.default_rng(seed)
    p = np.zeros(len(_KEYS))
    for name, value in BASE.items():
        p[_I[name]] = value * (1 + float(np.clip(rng.normal(0, off), -0.02, 0.02)) if off else 1.0)
    for name, value in truth.plant.items():
        p[_I[name]] = value
    p[_I["rigid_tyre"]] = 1.0 if truth.two_inertia else 0.0
    found = []
    for name, (request, speed) in torques(rng, short).items():
        if only and name not in only:
            continue
        acting = np.sign(request) * np.maximum(0.0, np.abs(request) - truth.deadband)
        acting = np.clip(acting, -truth.saturation, truth.saturation)
        if truth.rate_limit < math.inf:
            slewed = np.empty_like(acting)
            last = acting[0]
            for k, wanted in enumerate(acting):
                last += min(max(wanted - last, -truth.rate_limit * 1e-3), truth.rate_limit * 1e-3)
                slewed[k] = last
            acting = slewed
        out = np.empty((len(request), 3))
        _integrate(acting, 1e-3, p, np.array([speed * p[1], speed]), out)
        channels = {"time_s": np.arange(len(request)) * 1e-3, "motor_torque_ref_nm": request}
        for column, channel in enumerate(CHANNELS):
            values = out[:, column]
            late = truth.skew.get(channel, 0.0) * 1e3
            if late:
                at = np.arange(len(values), dtype=float)
                values = np.interp(at - late, at, values)
            values = values * truth.gain.get(channel, 1.0) + truth.offset.get(channel, 0.0)
            values = values + rng.normal(0, noise[column], len(values))
            if channel in truth.step:
                values = np.round(values / truth.step[channel]) * truth.step[channel]
            channels[channel] = values
        found.append(Recording(channels, Path(f"{name}.csv")))
    return found
