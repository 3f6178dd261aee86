"""What can be broken on a simulated bench, to see that the rest stays safe."""

from __future__ import annotations

from enum import Enum


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
