"""Rows of the table of faults for values that are not measured any more, though their frames keep coming."""

from __future__ import annotations

from sim_backend.bench import DYNO_BUS
from tests.faults import injecting as I
from tests.faults.expected import EITHER, LIVE, PASSED, FaultRow, row
from tests.faults.stage import Stage

_FROZEN = "repeats bit for bit"
_UNDER_TORQUE = ("stepping",)
_LEFT, _RIGHT = (0x183, 0x283), (0x184, 0x284)  # TPDO 1 and 2

_BEFORE = LIVE[:4]  # a sensor that is wrong from before a segment on, and from its middle
_TORQUES = ("shaft_torque_left_nm", "shaft_torque_right_nm")
_WHEELS = ("wheel_speed_left_rad_s", "wheel_speed_right_rad_s")


def _wrong(id_: str, title: str, *channels: str, **fault: float) -> FaultRow:
    """Sensors that read otherwise; what contradicts its neighbours is found when the run is judged."""

    def spoil(stage: Stage) -> None:
        for channel in channels:
            I.sensor(channel, **fault)(stage)

    return row(id_, title, lambda: I.Does(spoil), within_s=None, phases=_BEFORE)


SENSORS: tuple[FaultRow, ...] = (
    row(
        "frozen-dynos",
        "both dynos' measured values repeat",
        lambda: I.Received(I.stuck(*_LEFT, *_RIGHT), DYNO_BUS),
        _FROZEN,
        phases=_UNDER_TORQUE,
        safe=EITHER,  # the statusword repeats too: whether the drive is off cannot be read
    ),
    row(
        "frozen-side",
        "one dyno's measured values repeat",
        lambda: I.Received(I.stuck(*_RIGHT), DYNO_BUS),
        _FROZEN,
        phases=_UNDER_TORQUE,
        safe=EITHER,  # the statusword repeats too: whether the drive is off cannot be read
    ),
    row(
        "frozen-status",
        "the RMCU's status repeats, its counter runs",
        lambda: I.Received(I.stuck_values()),
        _FROZEN,
        phases=_UNDER_TORQUE,
        safe=EITHER,  # its torque request is read from the same frame
    ),
    row(
        "flipped-status",
        "1 of 100 status frames has a flipped bit",
        lambda: I.Received(I.flipped_status(100)),
        code=PASSED,
        within_s=None,
        phases=_UNDER_TORQUE,
    ),
    row(
        "damaged",
        "1 of 50 of the RMCU's frames has flipped bits",
        lambda: I.Received(I.damaged(50)),
        code=PASSED,
        within_s=None,
        phases=LIVE[1:],
    ),
    _wrong("dead-torque", "both torque sensors read nothing", *_TORQUES, gain=0.0),
    _wrong("dead-side", "one torque sensor reads nothing", _TORQUES[0], gain=0.0),
    _wrong("half-torque", "both torque sensors read half", *_TORQUES, gain=0.5),
    _wrong("half-side", "one torque sensor reads half", _TORQUES[1], gain=0.5),
    _wrong("mirrored-side", "one torque sensor is mirrored", _TORQUES[1], gain=-1.0),
    _wrong("half-wheels", "both wheel speeds read half", *_WHEELS, gain=0.5),
    _wrong("mirrored-motor", "the motor speed is mirrored", "motor_speed_rad_s", gain=-1.0),
    row(
        "drifting-torque",
        "both torque sensors drift by 100 N m/s",
        lambda: I.Drifts(_TORQUES, 100.0),
        within_s=None,
        phases=_BEFORE,
    ),
)
