"""Names, units and meanings of channels (docs/reference/recordings.md), and numbers all packages share."""

from __future__ import annotations

import signal
from collections.abc import Container
from dataclasses import dataclass

#: Time between samples of the bench, s: what the RMCU, the dynamometers' frames and recordings keep to.
TICK_S = 0.001
#: Where passengers feel vibration of the driveline, Hz: the band whose energy is judged.
COMFORT_BAND_HZ = (8.0, 20.0)
#: What asks a command to end, all of them alike: Ctrl-C, a termination, a closed terminal, and the key that
#: would else leave a core. Windows has neither of the last two.
ENDING_SIGNALS = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT") if hasattr(signal, name)
)
#: Packages of this software, for logs and for versions.
PACKAGES = ("hil", "drivers", "sim_backend", "test_plans", "reports")


@dataclass(frozen=True)
class Channel:
    """One measured or computed quantity over time; the unit is SI and part of the name."""

    name: str
    unit: str
    symbol: str
    meaning: str


_ALL = (
    Channel("time_s", "s", "t", "time from the start of the recording, increasing"),
    Channel("motor_torque_ref_nm", "N m", "T_m*", "motor torque requested by the RMCU"),
    Channel("motor_torque_nm", "N m", "T_m", "torque reported by the inverter"),
    Channel("motor_speed_rad_s", "rad/s", "ω_m", "rotor speed relative to the housing"),
    Channel("wheel_speed_rad_s", "rad/s", "ω_l", "wheel speed at the dynos, mean of left and right"),
    Channel("shaft_torque_nm", "N m", "T_s", "drive shaft torque, left plus right, wheel side"),
    Channel("wheel_speed_left_rad_s", "rad/s", "ω_l,left", "wheel speed at the left dyno"),
    Channel("wheel_speed_right_rad_s", "rad/s", "ω_l,right", "wheel speed at the right dyno"),
    Channel("shaft_torque_left_nm", "N m", "T_s,left", "torque of the left drive shaft"),
    Channel("shaft_torque_right_nm", "N m", "T_s,right", "torque of the right drive shaft"),
    Channel("vehicle_speed_m_s", "m/s", "V̂", "vehicle speed from the dyno controller's vehicle model"),
    Channel("driving_torque_ref_nm", "N m", "rF_d*", "requested driving torque"),
    Channel("driving_torque_est_nm", "N m", "rF̂_d", "driving torque estimated by the observer"),
    Channel("dyno_torque_ref_nm", "N m", "T_dyno", "load torque of the dynos, left plus right"),
    Channel("motor_angle_rad", "rad", "θ_m", "rotor angle relative to the housing, as an encoder gives it"),
    Channel(
        "wheel_angle_rad", "rad", "θ_l", "wheel angle at the dynos, as an encoder gives it; orders follow it"
    ),
)

CHANNELS: dict[str, Channel] = {channel.name: channel for channel in _ALL}

_UNITS = {"_rad_s": "rad/s", "_m_s": "m/s", "_nm": "N m", "_rad": "rad", "_km_h": "km/h", "_s": "s"}


def unit_of(name: str) -> str:
    """Unit of a channel, of one that is not in `CHANNELS` as its name ends; '' if that says none."""
    if name in CHANNELS:
        return CHANNELS[name].unit
    return next((unit for ending, unit in _UNITS.items() if name.endswith(ending)), "")


MOTOR_ANGLE, WHEEL_ANGLE = "motor_angle_rad", "wheel_angle_rad"
TIME = "time_s"
INPUT = "motor_torque_ref_nm"
OUTPUTS = ("motor_speed_rad_s", "wheel_speed_rad_s", "shaft_torque_nm")
#: The angle that stands for an output where that was not recorded.
ANGLES = {OUTPUTS[0]: MOTOR_ANGLE, OUTPUTS[1]: WHEEL_ANGLE}
#: What a recording needs one of.
ANY_OUTPUT = (*OUTPUTS, *ANGLES.values())


def read_from(channels: Container[object]) -> dict[str, str]:
    """The outputs that there are among channels, each with what it is read from: itself or its angle."""
    own = {name: name if name in channels else ANGLES.get(name, "") for name in OUTPUTS}
    return {name: channel for name, channel in own.items() if channel in channels}
