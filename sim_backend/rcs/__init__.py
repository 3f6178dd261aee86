"""RC-S style dynamometers, emulated: CANopen nodes with CiA 402 drives and a vehicle model."""

from sim_backend.rcs._node import DynoNode, read_node
from sim_backend.rcs._objects import State
from sim_backend.rcs._panel import EmulatedPanel, PanelPort

__all__ = ["DynoNode", "EmulatedPanel", "PanelPort", "State", "read_node"]
