"""The dynamometers on their CANopen bus."""

from drivers.dyno._driver import DynoDriver, DynoNodes, VehicleParameters
from drivers.dyno._node import identifiers_of, read_dyno

__all__ = ["DynoDriver", "DynoNodes", "VehicleParameters", "identifiers_of", "read_dyno"]
