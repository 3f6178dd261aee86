"""The dynamometers on their CANopen bus."""

from drivers.dyno._driver import DynoDriver, DynoNodes, VehicleParameters

__all__ = ["DynoDriver", "DynoNodes", "VehicleParameters"]
