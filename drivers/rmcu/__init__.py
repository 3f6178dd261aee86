"""The Rear Motor Control Unit on its CAN bus."""

from drivers.rmcu._driver import RmcuDriver, read_rmcu

__all__ = ["RmcuDriver", "read_rmcu"]
