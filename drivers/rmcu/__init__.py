"""The Rear Motor Control Unit on its CAN bus."""

from drivers.rmcu._driver import RMCU_SIGNALS, RmcuDriver, read_rmcu
from drivers.rmcu._parameters import parameters_of
from drivers.rmcu._table import RmcuTable

__all__ = ["RMCU_SIGNALS", "RmcuDriver", "RmcuTable", "parameters_of", "read_rmcu"]
