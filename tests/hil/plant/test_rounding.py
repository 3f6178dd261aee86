"""A kernel gives the same bits whoever built it: without optimisation, or for a plain processor."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[3]
#: A play that opens and shuts, friction that sticks, a ripple, a low-pass: what a last bit can tip over.
RUN = """
import sys
import numpy as np
from hil.core.model import EffectUse, Model
from hil.plant import ideal_sensors, pack, sensor_of, simulate_many

model = Model(
    "three_inertia",
    {
        "motor_inertia": 0.02, "gear_ratio": 8.148, "shaft_stiffness": 6089.0, "shaft_damping": 19.75,
        "wheel_inertia": 4.355, "tyre_stiffness": 5717.0, "tyre_damping": 351.0, "vehicle_inertia": 303.0,
        "torque_delay": 0.0035,
    },
    (
        EffectUse("backlash", {"half_gap_rad": 0.01, "contact_damping_nms_rad": 60.0}),
        EffectUse("coulomb_friction", {"torque_nm": 1.0, "turn_rad": 0.05}),
        EffectUse("motor_order_ripple", {"order": 3.0, "amplitude_nm": 0.5, "phase_rad": 0.3}),
        EffectUse("torque_rate_limit", {"limit_nm_s": 900.0}),
        EffectUse("sensor_lag", {"channel": "motor_speed_rad_s", "time_constant_s": 0.002}),
    ),
)
time_s = np.arange(1500) * 1e-3
torque = 15.0 * np.sin(2.0 * np.pi * (1.0 * time_s + 4.0 * time_s**2))
sensors = ideal_sensors(1)
sensors[0, 0] = sensor_of(model, "motor_speed_rad_s")
np.save(sys.argv[1], simulate_many(pack(model)[None], torque, 1e-3, np.zeros((1, 3)), sensors)[0])
"""


def ran(out: Path, **settings: str) -> np.ndarray:
    subprocess.run(
        [sys.executable, "-c", RUN, str(out)],
        cwd=ROOT,
        env={**os.environ, **settings},
        check=True,
        capture_output=True,
        text=True,
    )
    return np.load(out)


@pytest.mark.parametrize(
    "build",
    [
        pytest.param({"NUMBA_OPT": "0"}, marks=pytest.mark.hunt),
        pytest.param({"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""}, marks=pytest.mark.slow),
    ],
)
def test_a_kernel_that_was_built_otherwise_rounds_alike(tmp_path, build):
    usual = ran(tmp_path / "usual.npy")
    other = ran(tmp_path / "other.npy", NUMBA_CACHE_DIR=str(tmp_path / "cache"), **build)
    assert np.ptp(usual[:, 2]) > 100.0
    np.testing.assert_array_equal(usual, other)
