"""The Rear Motor Control Unit, emulated: the whole of the paper's Fig. 3 behind its CAN frames."""

from hil.plant.controller import LARGEST_TORQUE_NM
from sim_backend.rmcu._node import NEEDED, RmcuNode
from sim_backend.rmcu._requests import REQUEST_TIMEOUT_S

__all__ = ["LARGEST_TORQUE_NM", "NEEDED", "REQUEST_TIMEOUT_S", "RmcuNode"]
