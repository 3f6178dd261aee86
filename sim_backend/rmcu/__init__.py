"""The Rear Motor Control Unit, emulated: the whole of the paper's Fig. 3 behind its CAN frames."""

from hil.plant.controller import LARGEST_TORQUE_NM
from sim_backend.rmcu._memory import INTERNALS, RamSettings, RmcuMemory
from sim_backend.rmcu._node import NEEDED, RmcuNode
from sim_backend.rmcu._requests import REQUEST_TIMEOUT_S
from sim_backend.rmcu._xcp import STAMP_BYTES, STAMP_TICK_S, DaqList, XcpSlave

__all__ = [
    "INTERNALS",
    "LARGEST_TORQUE_NM",
    "NEEDED",
    "REQUEST_TIMEOUT_S",
    "STAMP_BYTES",
    "STAMP_TICK_S",
    "DaqList",
    "RamSettings",
    "RmcuMemory",
    "RmcuNode",
    "XcpSlave",
]
