"""RC-S style dynamometers, emulated: CANopen nodes with CiA 402 drives and a vehicle model."""

from sim_backend.rcs._node import DynoNode

__all__ = ["DynoNode"]
