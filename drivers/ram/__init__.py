"""A monitor of the RMCU's memory: XCP on CAN, synchronous DAQ, addresses from an A2L or a table."""

from drivers.ram._monitor import RamMonitor
from drivers.ram._table import RamTable

__all__ = ["RamMonitor", "RamTable"]
