"""Drivers: the RMCU and the dynamometers on the wire, in one loop, by one clock."""

from drivers.dyno import DynoDriver, DynoNodes, VehicleParameters, identifiers_of, read_dyno
from drivers.loop import TICK_S, BusLoop
from drivers.measurement import Binding, SampleAssembler
from drivers.rmcu import RmcuDriver, parameters_of, read_rmcu
from drivers.wire import Wire

__all__ = [
    "TICK_S",
    "Binding",
    "BusLoop",
    "DynoDriver",
    "DynoNodes",
    "RmcuDriver",
    "SampleAssembler",
    "VehicleParameters",
    "Wire",
    "identifiers_of",
    "parameters_of",
    "read_dyno",
    "read_rmcu",
]
