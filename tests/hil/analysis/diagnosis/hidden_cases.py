"""Hidden truths by seed: effects at three sizes, pairs, nothing, and what no registry knows."""

from __future__ import annotations

import numpy as np

from tests.hil.analysis.diagnosis.reference_plant import BASE, CHANNELS, Truth

SIZES = {"small": 0.15, "medium": 0.45, "large": 1.0}
EFFECTS = (
    "dead_time",
    "actuator_lag",
    "torque_saturation",
    "torque_rate_limit",
    "torque_deadband",
    "backlash",
    "shaft_cubic_stiffness",
    "shaft_hysteresis",
    "coulomb_friction",
    "viscous_drag",
    "mount_mode",
    "wheel_order_disturbance",
    "motor_order_ripple",
    "running_resistance",
    "sensor_gain",
    "sensor_offset",
    "channel_skew",
    "sensor_quantization",
    "parameter_mismatch",
)
OUTSIDE = ("tyre_slip", "fixed_line", "stiffness_drift")
_NOISE = dict(zip(CHANNELS, (0.15, 0.02, 1.5), strict=True))
_TYPICAL = dict(zip(CHANNELS, (30.0, 4.0, 120.0), strict=True))


def hide(truth: Truth, effect: str, size: float, rng: np.random.Generator) -> tuple[str, dict[str, float]]:
    """Add an effect of `size` (1: plain to see) to `truth`; returns what it speaks of and its values."""
    p = truth.plant
    s = size * rng.uniform(0.8, 1.25)
    channel = CHANNELS[int(rng.integers(3))]
    if effect == "dead_time":
        value = 0.006 * s
        p["torque_delay"] = BASE["torque_delay"] + value
        return "", {"extra_delay_s": value}
    if effect == "actuator_lag":
        p["lag"] = 0.012 * s
        return "", {"time_constant_s": p["lag"]}
    if effect == "torque_saturation":
        truth.saturation = 32.0 * (1 - 0.5 * min(s, 1.6))
        return "", {"limit_nm": truth.saturation}
    if effect == "torque_rate_limit":
        truth.rate_limit = 500.0 / s
        return "", {"limit_nm_s": truth.rate_limit}
    if effect == "torque_deadband":
        truth.deadband = 2.5 * s
        return "", {"half_width_nm": truth.deadband}
    if effect == "backlash":
        p["gap"] = 0.02 * s
        return "", {"half_gap_rad": p["gap"]}
    if effect == "shaft_cubic_stiffness":
        p["cubic"] = float(rng.choice([-1, 1.5])) * 3e5 * s
        return "", {"coefficient_nm_rad3": p["cubic"]}
    if effect == "shaft_hysteresis":
        p["bouc_wen"] = float(rng.integers(2))
        p["hyst_k"], p["hyst_slip"] = 1500.0 * s, 0.01 * rng.uniform(0.5, 1.5)
        return "", {"stiffness_nm_rad": p["hyst_k"], "slip_rad": p["hyst_slip"]}
    if effect == "coulomb_friction":
        p["coulomb"] = 2.0 * s
        if rng.random() < 0.4:
            p["stribeck"] = 0.4 * p["coulomb"]
        return "", {"torque_nm": p["coulomb"]}
    if effect == "viscous_drag":
        p["drag"] = 0.015 * s
        return "", {"coefficient_nms_rad": p["drag"]}
    if effect == "mount_mode":
        omega = 2 * np.pi * rng.uniform(9, 20)
        p["mount_j"] = 2.0 / s
        p["mount_k"] = p["mount_j"] * omega**2
        p["mount_c"] = 2 * rng.uniform(0.04, 0.12) * omega * p["mount_j"]
        return "", {"housing_inertia_kg_m2": p["mount_j"], "mount_stiffness_nm_rad": p["mount_k"]}
    if effect == "wheel_order_disturbance":
        p["w_order"], p["w_amp"], p["w_phase"] = float(rng.integers(1, 7)), 25.0 * s, rng.uniform(-3, 3)
        return "", {"order": p["w_order"], "amplitude_nm": p["w_amp"]}
    if effect == "motor_order_ripple":
        p["m_order"], p["m_amp"] = float(rng.choice([1, 2, 4, 6, 8, 12])), 1.5 * s
        p["m_phase"] = rng.uniform(-3, 3)
        return "", {"order": p["m_order"], "amplitude_nm": p["m_amp"]}
    if effect == "running_resistance":
        p["rolling"], p["aero"] = 25.0 * s, 0.06 * s * rng.uniform(0.3, 1.5)
        return "", {"rolling_nm": p["rolling"], "aero_nms2_rad2": p["aero"]}
    if effect == "sensor_gain":
        truth.gain[channel] = 1 + float(rng.choice([-1, 1])) * (0.03 + 0.07 * s)
        return channel, {"gain": truth.gain[channel]}
    if effect == "sensor_offset":
        truth.offset[channel] = float(rng.choice([-1, 1])) * 0.15 * _TYPICAL[channel] * s
        return channel, {"offset": truth.offset[channel]}
    if effect == "channel_skew":
        truth.skew[channel] = 0.008 * s
        return channel, {"delay_s": truth.skew[channel]}
    if effect == "sensor_quantization":
        truth.step[channel] = _NOISE[channel] * 8 * s
        return channel, {"step": truth.step[channel]}
    if effect == "parameter_mismatch":
        name = str(rng.choice([k for k in BASE if k != "torque_delay"]))
        p[name] = BASE[name] * (1 + float(rng.choice([-1, 1])) * (0.04 + 0.2 * s))
        return name, {"value": p[name]}
    return _outside(truth, effect, s)


def _outside(truth: Truth, effect: str, s: float) -> tuple[str, dict[str, float]]:
    p = truth.plant
    if effect == "tyre_slip":
        p["slip_coefficient"] = 250.0 / s
    elif effect == "fixed_line":
        p["torque_line_hz"], p["torque_line_nm"] = 13.0, 1.5 * s
    elif effect == "stiffness_drift":
        p["drift"] = 0.3 * s
    else:
        raise ValueError(effect)
    return "", {}


def draw(
    effects: tuple[str, ...], size: float, seed: int
) -> tuple[Truth, list[tuple[str, str, dict[str, float]]]]:
    """The truth with `effects`, and the answer: id, channel or parameter, values."""
    rng = np.random.default_rng([seed, 77])
    truth = Truth()
    answer = []
    for effect in effects:
        about, values = hide(truth, effect, size, rng)
        answer.append((effect, about, values))
    return truth, answer
