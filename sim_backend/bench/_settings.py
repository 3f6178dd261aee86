"""What a bench file says about its simulation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from hil.core.dbc import Names
from hil.core.model import Model


@dataclass(frozen=True)
class Noise:
    """Standard deviations of the sensors' noise (white, independent from sample to sample)."""

    motor_speed_rad_s: float = 0.02
    wheel_speed_rad_s: float = 0.002
    shaft_torque_nm: float = 0.5  # each side


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
    names: Names = field(default_factory=Names)  # what the DBC calls things
    held: Mapping[str, float] = field(
        default_factory=dict
    )  # parameters that the RMCU keeps, whatever it is told
