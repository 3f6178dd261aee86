"""What a bench file says about its simulation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from hil.core.can.dbc import Names
from hil.core.model import Model
from sim_backend.rmcu import RamSettings


@dataclass(frozen=True)
class Noise:
    """Standard deviations of the sensors' noise (white, independent from sample to sample)."""

    motor_speed_rad_s: float = 0.02
    wheel_speed_rad_s: float = 0.002
    shaft_torque_nm: float = 0.5  # each side


@dataclass(frozen=True)
class SensorFault:
    """A sensor that reads gain times the truth plus offset (in its channel's unit)."""

    gain: float = 1.0
    offset: float = 0.0


#: Channels of the simulated sensors, in the order of the tick's rows.
SENSED_CHANNELS = (
    "motor_speed_rad_s",
    "wheel_speed_left_rad_s",
    "wheel_speed_right_rad_s",
    "shaft_torque_left_nm",
    "shaft_torque_right_nm",
)


@dataclass(frozen=True)
class SimulationSettings:
    """Everything that makes a simulated bench; two benches with equal settings give equal frames."""

    model: Model
    dbc: Path
    eds: Path
    rear_left: int = 3
    rear_right: int = 4
    idle: tuple[int, ...] = (1, 2)
    rmcu_bit_rate: int = 1_000_000
    dyno_bit_rate: int = 1_000_000
    wheel_radius_m: float = 0.33
    seed: int = 1
    noise: Noise = field(default_factory=Noise)
    sensors: Mapping[str, SensorFault] = field(default_factory=dict)  # by channel; others are well
    names: Names = field(default_factory=Names)  # what the DBC calls things
    held: Mapping[str, float] = field(
        default_factory=dict
    )  # parameters that the RMCU keeps, whatever is written
    ram: RamSettings | None = None  # what its memory shows by XCP
