"""A model with its controller as a unit for other simulation tools: FMI 2, co-simulation."""

from hil.fmu._export import export_fmu
from hil.fmu.axle import Axle

__all__ = ["Axle", "export_fmu"]
