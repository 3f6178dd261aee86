"""Dynamometers on CANopen, as one device."""

from drivers.dyno._driver import DynoDriver, DynoNodes
from drivers.dyno._node import identifiers_of, read_dyno
from drivers.dyno._table import DynoTable

__all__ = ["DynoDriver", "DynoNodes", "DynoTable", "identifiers_of", "read_dyno"]
