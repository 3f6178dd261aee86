"""The simulated bench as a whole: what stands at the other end of the wire when hardware is absent."""

from sim_backend.bench._device_files import check_device_files
from sim_backend.bench._outgoing import DYNO_BUS, RAM_BUS, RMCU_BUS
from sim_backend.bench._settings import SENSED_CHANNELS, Fault, Noise, SensorFault, SimulationSettings, Tamper
from sim_backend.bench._world import SimulatedBench

__all__ = [
    "DYNO_BUS",
    "RAM_BUS",
    "RMCU_BUS",
    "SENSED_CHANNELS",
    "Fault",
    "Noise",
    "SensorFault",
    "SimulatedBench",
    "SimulationSettings",
    "Tamper",
    "check_device_files",
]
