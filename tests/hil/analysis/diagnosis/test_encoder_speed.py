"""A speed that is differences of an encoder's positions: its noise grows with frequency.

The axis is simulated here, in steps of 25 µs and with dry friction that holds it still, without any code of
the project.
"""

from __future__ import annotations

from pathlib import Path

import numba
import numpy as np
import numpy.typing as npt
import pytest

from hil.analysis.diagnosis import diagnose
from hil.core.model import Model
from hil.core.recording import Recording

Array = npt.NDArray[np.float64]

INERTIA, DRAG, FRICTION, OFFSET = 0.01, 0.004, 0.02, 0.005
COUNTS = 4096
MODEL = Model(
    "rigid",
    {
        "motor_inertia": 0.009,
        "gear_ratio": 1.0,
        "vehicle_inertia": 0.001,
        "viscous_drag": DRAG,
        "torque_delay": 0.0,
    },
)


@numba.njit  # type: ignore[untyped-decorator]
def controlled(wanted: Array, count_rad: float) -> tuple[Array, Array]:
    """Torque and speed read each millisecond; a PI controller acts on the speed that is read."""
    step = 25e-6
    angle, speed, integral, before = 0.0, 0.0, 0.0, 0.0
    torque, read = np.zeros(len(wanted)), np.zeros(len(wanted))
    for i in range(len(wanted)):
        counted = np.floor(angle / count_rad) * count_rad
        read[i] = (counted - before) / 1e-3
        before = counted
        error = wanted[i] - read[i]
        integral += 1.5e-3 * error
        torque[i] = 0.3 * error + integral
        for _ in range(40):
            push = torque[i] - DRAG * speed - OFFSET
            held = min(max(push + INERTIA * speed / step, -FRICTION), FRICTION)
            speed += step / INERTIA * (push - held)
            angle += step * speed
    return torque, read


def recording(seconds: float = 25.0) -> Recording:
    time = np.arange(0.0, seconds, 1e-3)
    wanted = 8.0 * np.sin(2 * np.pi * 0.3 * time) + 4.0 * np.sin(2 * np.pi * 1.1 * time + 0.4)
    wanted += 5.0 * np.sign(np.sin(2 * np.pi * 0.13 * time))
    torque, speed = controlled(np.where(time < 1.0, 0.0, wanted), 2.0 * np.pi / COUNTS)
    channels = {"time_s": time, "motor_torque_ref_nm": torque, "motor_speed_rad_s": speed}
    return Recording(channels, Path("encoder.csv"))


@pytest.mark.slow
def test_friction_and_its_offset_are_found_from_a_coarse_encoder_alone() -> None:
    """Weighed as white noise, rolling resistance beside a sensor's offset seemed to close the gap."""
    found = diagnose(MODEL, [recording()])
    named = {effect.use.id: effect for effect in found.effects}
    assert found.verdict == "named"
    assert set(named) == {"coulomb_friction", "sensor_quantization"}
    friction = named["coulomb_friction"]
    for name, truth in (("torque_nm", FRICTION), ("offset_nm", OFFSET)):
        assert friction.use.values[name] == pytest.approx(truth, rel=0.01)
        assert abs(float(friction.use.values[name]) - truth) < 3.0 * friction.standard_error[name]
