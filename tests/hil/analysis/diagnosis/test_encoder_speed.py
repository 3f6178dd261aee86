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

from hil.analysis.diagnosis import diagnose, examine
from hil.core.errors import BadInputError
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
    """Weighed as white noise, rolling resistance beside a sensor's offset seemed to close the gap.

    Differences of positions are half a sample late: that is a number, if it is named at all.
    """
    found = diagnose(MODEL, [recording()])
    named = {effect.use.id: effect for effect in found.effects}
    assert found.verdict == "named"
    assert set(named) - {"parameter_mismatch"} == {"coulomb_friction", "sensor_quantization"}
    assert found.model.parameters["torque_delay"] == pytest.approx(5e-4, abs=2e-4)
    friction = named["coulomb_friction"]
    for name, truth in (("torque_nm", FRICTION), ("offset_nm", OFFSET)):
        assert friction.use.values[name] == pytest.approx(truth, rel=0.01)
        assert abs(float(friction.use.values[name]) - truth) < 3.0 * friction.standard_error[name]


def by_counts(one: Recording) -> Recording:
    """The same as the encoder gives it."""
    channels = {name: one[name] for name in ("time_s", "motor_torque_ref_nm")}
    angle = np.cumsum(one["motor_speed_rad_s"]) * 1e-3
    return Recording(channels | {"motor_angle_rad": angle}, Path("counts.csv"))


@pytest.mark.slow
def test_counts_themselves_tell_friction_and_its_offset_better() -> None:
    """Their steps are noise of an angle, which does not walk off, and no effect."""
    found = diagnose(MODEL, [by_counts(recording())])
    (friction,) = found.effects
    assert (found.verdict, friction.use.id) == ("named", "coulomb_friction")
    for name, truth in (("torque_nm", FRICTION), ("offset_nm", OFFSET)):
        assert friction.use.values[name] == pytest.approx(truth, rel=0.005)
    assert found.as_json()["gap"]["motor_angle_rad"]["after"] < 2e-3
    assert found.open_channels == ()


def test_a_speed_here_and_an_angle_there_are_refused() -> None:
    both = [recording(3.0), by_counts(recording(4.0))]
    with pytest.raises(BadInputError, match="has motor_angle_rad and no motor_speed_rad_s") as caught:
        diagnose(MODEL, both[:1], both[1:])
    assert "give the same of the two" in caught.value.fix


def test_an_encoder_that_stands_still_is_not_frozen_and_refusals_name_the_angle() -> None:
    one = by_counts(recording(4.0))
    uneven = one.time_s + np.random.default_rng(0).uniform(-3e-4, 3e-4, one.samples)
    assert len(examine(MODEL, [Recording({**one.channels, "time_s": uneven}, one.source)])[0]) == 1
    degrees = Recording({**one.channels, "motor_angle_rad": np.degrees(one["motor_angle_rad"])}, one.source)
    with pytest.raises(BadInputError, match="motor_angle_rad changes") as caught:
        diagnose(MODEL, [degrees])
    assert "in degrees, or in counts" in caught.value.fix
