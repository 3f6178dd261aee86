"""A recording as the acceptance plan leaves it, from closed forms: 96 s at 1 kHz, four step segments."""

from __future__ import annotations

import hashlib
from pathlib import Path

import numpy as np

from hil.core.recording import Event, Recording
from hil.core.result import CriterionResult, RunResult, Segment

REFERENCE_NM = 326.0
GEAR = 8.148
_CASES = {  # controller, km/h, overshoot N m, ripple of T_s N m
    "gain_0kmh": ("gain", 0.0, 38.0, 2.0),
    "phase_0kmh": ("phase", 0.0, 31.0, 1.4),
    "gain_20kmh": ("gain", 20.0, 92.0, 9.0),
    "phase_20kmh": ("phase", 20.0, 47.0, 5.0),
}
_CHANNELS = (
    "motor_torque_ref_nm",
    "motor_torque_nm",
    "motor_speed_rad_s",
    "wheel_speed_rad_s",
    "shaft_torque_nm",
    "vehicle_speed_m_s",
    "driving_torque_ref_nm",
    "driving_torque_est_nm",
)
_DEFINITIONS = {
    "peak_shaft_torque": "Largest value of T_s from the step until the end of the segment.",
    "overshoot_shaft_torque": "Peak of T_s minus the reference, not below 0.",
    "settling_shaft_torque": "Time from the step after which T_s, low-pass filtered at 50 Hz, stays within "
    "±5 % of the step's size around its mean over the last 2 s.",
    "band_energy_motor_speed": "Linear trend of ω_m removed, Hann window, one-sided power spectral density "
    "of 4 to 20 s after the step, integrated over 8 to 20 Hz, both edges included.",
}
_PLAN = b"title: Acceptance of driving torque control\nsteps: []\n"
_CONTROLLER = b"""name = "%s"
torque_limit_nm = 200.0
[dfc]
integral_gain = 0.001
[wsc]
proportional_gain = 2.6775
integral_gain = 0.4016
filter_time_constant_s = 0.05
[wsc.%s]
"""


def segments() -> tuple[Segment, ...]:
    return tuple(
        Segment(
            id=name,
            start_s=24.0 * k + 2,
            step_s=24.0 * k + 3,
            end_s=24.0 * k + 23,
            controller=controller,
            initial_speed_km_h=speed,
            reference_after=REFERENCE_NM,
        )
        for k, (name, (controller, speed, _, _)) in enumerate(_CASES.items())
    )


def recording() -> Recording:
    noise = np.random.default_rng(7)
    time = np.arange(96_000) / 1000.0
    channels = {"time_s": time} | {name: np.zeros_like(time) for name in _CHANNELS}
    for segment, (_, speed, overshoot, ripple) in zip(segments(), _CASES.values(), strict=True):
        inside = slice(round(segment.start_s * 1000), round(segment.end_s * 1000) + 1)
        t = time[inside] - segment.step_s
        after = t >= 0
        u = np.maximum(t, 0)
        rise = (1 - np.exp(-u / 0.09)) * REFERENCE_NM
        swing = overshoot * 2.1 * np.exp(-2.2 * u) * np.sin(2 * np.pi * 1.1 * u) * after
        shake = 0.4 * overshoot * np.exp(-5 * u) * np.sin(2 * np.pi * 10.6 * u) * after
        order = ripple * np.sin(2 * np.pi * (8.0 + 0.15 * u) * t) if speed else 0.0
        torque = rise + swing + shake + order + noise.normal(0, 0.8, len(t))
        wheel = speed / 3.6 / 0.33 + np.cumsum(torque * after) * 0.001 / 303.0
        motor = wheel * GEAR + 0.004 * (swing + shake) + 0.1 * np.asarray(order)
        channels["shaft_torque_nm"][inside] = torque
        channels["wheel_speed_rad_s"][inside] = wheel
        channels["motor_speed_rad_s"][inside] = motor + noise.normal(0, 0.05, len(t))
        channels["vehicle_speed_m_s"][inside] = wheel * 0.33
        channels["driving_torque_ref_nm"][inside] = REFERENCE_NM * after
        channels["driving_torque_est_nm"][inside] = rise + 0.7 * swing
        channels["motor_torque_ref_nm"][inside] = (rise + 0.5 * swing) / GEAR - 0.02 * np.asarray(order)
        channels["motor_torque_nm"][inside] = channels["motor_torque_ref_nm"][inside]
    attachments = {
        "plan.yaml": _PLAN,
        "bench.toml": b'name = "sim"\n',
        "controller/gain.toml": _CONTROLLER % (b"gain", b"notch") + b"frequency_hz = 10.6\nwidth = 2.0\n",
        "controller/phase.toml": _CONTROLLER % (b"phase", b"lead") + b"alpha = 0.2596\n",
    }
    return Recording(
        channels,
        Path("recording.mcap"),
        metadata=_metadata(attachments),
        attachments=attachments,
        events=_events(),
    )


def result() -> RunResult:
    rec = recording()
    criteria: list[CriterionResult] = []
    for segment, (_, speed, _, ripple) in zip(segments(), _CASES.values(), strict=True):
        after = rec.between(segment.step_s, segment.end_s)["shaft_torque_nm"]
        peak = float(after.max())
        values = {
            "peak_shaft_torque": (peak, "N m", 723.0 if speed else 534.0),
            "overshoot_shaft_torque": (peak - REFERENCE_NM, "N m", 120.0),
            "settling_shaft_torque": (0.7312 + ripple / 20, "s", 2.0),
            "band_energy_motor_speed": ((0.1 * ripple) ** 2 / 2 + 0.012, "(rad/s)²", 2.5),
        }
        for metric, (value, unit, upper) in values.items():
            criteria.append(
                CriterionResult(
                    id=f"{segment.id}.{metric}",
                    title=metric.replace("_", " ").capitalize(),
                    value=value,
                    unit=unit,
                    upper=upper,
                    verdict="pass" if value <= upper else "fail",
                    definition=_DEFINITIONS[metric],
                )
            )
    return RunResult(
        verdict="pass",
        plan="acceptance",
        bench="sim",
        real_time_factor=34.2,
        bench_time_s=96.0,
        safe_state="confirmed",
        criteria=tuple(criteria),
        segments=segments(),
    )


def _metadata(attachments: dict[str, bytes]) -> dict[str, dict[str, str]]:
    return {
        "run": {
            "plan": "acceptance",
            "title": "Acceptance of driving torque control",
            "bench": "sim",
            "operator": "A. Operator",
            "started_at": "2026-03-04T09:15:00+01:00",
            "simulated": "true",
        },
        "dut": {"name": "Rear e-Axle", "serial": "EA-0042", "gear_ratio": "8.148"},
        "versions": {"eaxle-hil": "0.1.0", "python": "3.11.9", "numpy": "2.2.0", "git": "deadc42"},
        "hashes": {name: hashlib.sha256(content).hexdigest() for name, content in attachments.items()},
        "calibration": {"shaft torque left": "2026-11-30", "shaft torque right": "2026-01-31"},
    }


def _events() -> list[Event]:
    events = [Event(0.0, "preflight", "all devices answer"), Event(0.8, "armed", "torque limit 200 N m")]
    for segment in segments():
        events.append(Event(segment.start_s, "segment", f"{segment.id}: controller {segment.controller}"))
    return [*events, Event(95.6, "safe state", "confirmed by RMCU, dyno left, dyno right")]
