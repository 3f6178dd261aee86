"""Plant, sensors, drives and the RMCU's control as one compiled loop, sample by sample.

`tick` is one millisecond, on the wire and in predictions; `ClosedLoop` executes many at once.
"""

from hil.core.channels import TICK_S
from hil.plant.closed_loop._noise import Noise
from hil.plant.closed_loop._state import State, state_at_rest
from hil.plant.closed_loop.advance import advance
from hil.plant.closed_loop.closed_loop import SIDES, ClosedLoop
from hil.plant.closed_loop.shown import Wire, rounded

__all__ = [
    "SIDES",
    "TICK_S",
    "ClosedLoop",
    "Noise",
    "State",
    "Wire",
    "advance",
    "rounded",
    "state_at_rest",
]
