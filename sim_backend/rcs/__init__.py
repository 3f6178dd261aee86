"""RC-S style dynamometers, emulated: CANopen nodes with CiA 402 drives and a vehicle model."""

from sim_backend.rcs._node import DynoNode, read_node
from sim_backend.rcs._panel import EmulatedPanel, PanelPort
from sim_backend.rcs._power_states import State

__all__ = ["DynoNode", "EmulatedPanel", "PanelPort", "State", "read_node"]
