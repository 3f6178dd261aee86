"""The RMCU's control (Fig. 3 of the paper), compiled: DFC, WSC and DFO by Tustin's rule.

One place for the emulated RMCU on the wire, for predictions and for tuning.
"""

from hil.core.controller.bounds import LARGEST_TORQUE_NM
from hil.plant.controller.control import control
from hil.plant.controller.memory import Memory
from hil.plant.controller.parameters import build, in_range

__all__ = ["LARGEST_TORQUE_NM", "Memory", "build", "control", "in_range"]
