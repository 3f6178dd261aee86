"""Drivers: devices on their wires, in one loop, by one clock."""

from drivers._waiting import StreamTiming
from drivers.bus_health import BusHealth
from drivers.bus_load import bits_on_the_wire, most_bits_on_the_wire
from drivers.can_adapter import CanSettings, open_can
from drivers.device import (
    Device,
    Examinable,
    Examined,
    Finding,
    Identifies,
    Incomplete,
    MotorControl,
    SaysDamage,
    SaysEmergency,
    SaysPowerless,
    SetsSlip,
    SetsVehicle,
    TakesBack,
    WheelLoad,
)
from drivers.dyno import DynoDriver, DynoNodes, DynoTable, read_dyno
from drivers.echoes import NewestFrames
from drivers.frame_source import Binding, CountedBy, FrameSource
from drivers.listening_wire import ListeningWire, LogWire
from drivers.loop import BusLoop
from drivers.measurement import SampleAssembler
from drivers.panel import Panel, PanelTable
from drivers.ram import RamMonitor, RamTable
from drivers.rmcu import RmcuDriver, RmcuTable, parameters_of, read_rmcu
from drivers.samples import Counting, SampleQueue, Samples, SampleSource, Stream
from drivers.serial_line import SerialLine
from drivers.table import Connections, DeviceTable, File, LoadTable, Name, VehicleParameters
from drivers.wire import Wire
from hil.core.channels import TICK_S

#: Kinds of device that come with the project; others come by entry point.
OWN_KINDS: tuple[tuple[str, type[DeviceTable]], ...] = (
    ("rmcu-can", RmcuTable),
    ("rcs-canopen", DynoTable),
    ("rcs-panel", PanelTable),
    ("ram-xcp", RamTable),
)

__all__ = [
    "OWN_KINDS",
    "TICK_S",
    "Binding",
    "BusHealth",
    "BusLoop",
    "CanSettings",
    "Connections",
    "CountedBy",
    "Counting",
    "Device",
    "DeviceTable",
    "DynoDriver",
    "DynoNodes",
    "DynoTable",
    "Examinable",
    "Examined",
    "File",
    "Finding",
    "FrameSource",
    "Identifies",
    "Incomplete",
    "ListeningWire",
    "LoadTable",
    "LogWire",
    "MotorControl",
    "Name",
    "NewestFrames",
    "Panel",
    "PanelTable",
    "RamMonitor",
    "RamTable",
    "RmcuDriver",
    "RmcuTable",
    "SampleAssembler",
    "SampleQueue",
    "SampleSource",
    "Samples",
    "SaysDamage",
    "SaysEmergency",
    "SaysPowerless",
    "SerialLine",
    "SetsSlip",
    "SetsVehicle",
    "Stream",
    "StreamTiming",
    "TakesBack",
    "VehicleParameters",
    "WheelLoad",
    "Wire",
    "bits_on_the_wire",
    "most_bits_on_the_wire",
    "open_can",
    "parameters_of",
    "read_dyno",
    "read_rmcu",
]
