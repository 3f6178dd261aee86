"""The Rear Motor Control Unit, emulated: the whole of the paper's Fig. 3 behind its CAN frames."""

from sim_backend.rmcu._node import NEEDED, REQUEST_TIMEOUT_S, RmcuNode
from sim_backend.rmcu._parameters import LARGEST_TORQUE_NM

__all__ = ["LARGEST_TORQUE_NM", "NEEDED", "REQUEST_TIMEOUT_S", "RmcuNode"]
