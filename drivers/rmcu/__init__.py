"""The Rear Motor Control Unit on its CAN bus."""

from drivers.rmcu._driver import RmcuDriver, read_rmcu
from drivers.rmcu._parameters import parameters_of

__all__ = ["RmcuDriver", "parameters_of", "read_rmcu"]
