"""What a bench file says about its simulation, and what tests can break on it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import Enum
from pathlib import Path
from typing import Protocol

import numpy as np
import numpy.typing as npt

from hil.core.can.dbc import Names
from hil.core.can.frames import FrameBlock
from hil.core.model import Model
from sim_backend.rmcu import RamSettings


class Fault(Enum):
    """A device that fails from now on."""

    RMCU_SILENT = "the RMCU sends nothing and hears nothing; it gives no torque"
    DYNO_SILENT = "the left rear dyno sends nothing and hears nothing; its drive is off"
    RMCU_DEAF = "the RMCU hears no requests but keeps sending its state"
    DYNO_DEAF = "the rear dynos hear no commands but keep sending their state"
    RMCU_RESET = "the RMCU boots for 0.3 s; then it is off, without parameters, and no request has come"
    DYNO_RESET = "the left rear dyno boots: its drive is off, what was configured is forgotten, its SYNC too"
    DYNO_FAULT = "the left rear drive goes to fault and tells why"
    DYNO_RUNAWAY = "the rear drives go to a speed that no one asked for, and cannot be switched off"


class Tamper(Protocol):
    """Loses, changes, delays and invents frames; breaks what it likes."""

    def time_passes(self, now_s: float) -> None:
        """The bench's time is `now_s`."""
        ...

    def to_hosts(self, bus: str, block: FrameBlock) -> FrameBlock:
        """What hosts get in place of the frames that nodes have sent since they last looked."""
        ...

    def to_nodes(self, bus: str, frame_id: int, data: bytes) -> Iterable[tuple[int, bytes]]:
        """What nodes get in place of a frame of a host; raises what an adapter would raise."""
        ...

    def look(self, first: int, rows: npt.NDArray[np.float64]) -> None:
        """Samples of the plant, from number `first` on: rows of `hil.plant.closed_loop.tick`."""
        ...


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
