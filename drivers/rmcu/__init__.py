"""The Rear Motor Control Unit on its CAN bus."""

from drivers.rmcu._driver import RmcuDriver

__all__ = ["RmcuDriver"]
