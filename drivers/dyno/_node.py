"""One dynamometer: CANopen node and CiA 402 drive."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import canopen
import numpy as np
import numpy.typing as npt

from drivers.dyno._canopen import SDO_TIMEOUT_S, BrokenOffError, LoopNetwork, LoopNode, abort_in_words
from drivers.echoes import NewestFrames
from drivers.frame_source import Binding
from hil.core.can.eds import identifier_of, layout_of_pdo, mapping_of, read_eds
from hil.core.can.signals import FrameLayout, in_units
from hil.core.errors import DeviceError

# CiA 402: statusword bits 6, 5, 3, 2, 1, 0
STATE_MASK = 0x6F
SWITCH_ON_DISABLED, READY, SWITCHED_ON, ENABLED, FAULT = 0x40, 0x21, 0x23, 0x27, 0x08
_STATE_NAMES = {
    SWITCH_ON_DISABLED: "switch on disabled",
    READY: "ready to switch on",
    SWITCHED_ON: "switched on",
    ENABLED: "operation enabled",
    0x07: "quick stop active",
    FAULT: "fault",
}
# What is written by SDO: index and subindex
_OBJECTS = ((0x1005, 0), (0x1006, 0), (0x1016, 1), (0x1017, 0), (0x6060, 0), (0x6083, 0))
_VEHICLE_OBJECTS = tuple((0x2000, subindex) for subindex in range(1, 7))
#: Mapping, communication parameter, identifier less the node id where the EDS says none, what is needed
_PDOS: tuple[tuple[int, int, int, tuple[str, ...]], ...] = (
    (0x1600, 0x1400, 0x200, ("Controlword", "Target velocity")),
    (0x1A00, 0x1800, 0x180, ("Wheel speed", "Shaft torque")),
    (0x1A01, 0x1801, 0x280, ("Statusword", "Torque actual value", "Vehicle speed")),
)
_UNITS = {
    "Target velocity": "rad/s",
    "Wheel speed": "rad/s",
    "Shaft torque": "N m",
    "Torque actual value": "N m",
    "Vehicle speed": "m/s",
}
_OF_COB_ID = 0xBFFF_FFFF  # all but whether a PDO may be asked for (bit 30)
_FRESH_S = 0.05
_REPEATS = 2
HEARTBEAT_LOST_S = 0.35


@dataclass(frozen=True)
class DynoFile:
    """What a dyno's EDS says: canopen's dictionary, the layouts of three PDOs, and remarks on their units."""

    dictionary: Any
    command: FrameLayout
    values: FrameLayout
    status: FrameLayout
    remarks: tuple[str, ...]


def read_dyno(eds: Path, node_id: int) -> DynoFile:
    """What the driver uses of a dyno's EDS.

    Raises:
        BadInputError: not an EDS, or it lacks an object or a mapping that is used.
    """
    dictionary = read_eds(eds, node_id, _OBJECTS, floats=_VEHICLE_OBJECTS)
    command, values, status = (
        layout_of_pdo(
            dictionary,
            mapping,
            identifier_of(dictionary, communication, usual + node_id, str(eds)),
            needed,
            str(eds),
        )
        for mapping, communication, usual, needed in _PDOS
    )
    remarks: list[str] = []
    command, values, status = (in_units(one, _UNITS, str(eds), remarks) for one in (command, values, status))
    return DynoFile(dictionary, command, values, status, tuple(remarks))


def identifiers_of(node_id: int, name: str, pdos: tuple[int, int, int] | None = None) -> dict[int, str]:
    """What a dyno sends or hears on its bus, with words for each.

    Args:
        pdos: identifiers of its values, command and status; None for those of CiA 301.
    """
    services = {0x80: "EMCY", 0x580: "SDO answer", 0x600: "SDO request", 0x700: "heartbeat"}
    found = {base + node_id: what for base, what in services.items()}
    ids = pdos or (0x180 + node_id, 0x200 + node_id, 0x280 + node_id)
    found |= dict(zip(ids, ("values", "command", "status"), strict=True))
    return {0x000: "NMT", 0x080: "SYNC"} | {one: f"{what} of {name}" for one, what in sorted(found.items())}


def _object(index: int, subindex: int) -> str:
    """An object of the dictionary, in words."""
    return f"object 0x{index:04X}" + (f", subindex {subindex}" if subindex else "")


class DynoNode:
    """Access to one node; `status` and `velocity` follow its PDOs."""

    def __init__(self, network: LoopNetwork, bus: str, node_id: int, name: str, eds: Path) -> None:
        self.id, self.name, self.bus = node_id, name, bus
        self._network = network
        file = read_dyno(eds, node_id)
        self._command, self._values, self._status = self._layouts = file.command, file.values, file.status
        self._eds = eds
        self._node: Any = LoopNode(node_id, file.dictionary)
        network.add_node(self._node)
        self._newest = NewestFrames({f.id: f.signals.values() for f in (self._status, self._values)})
        self._target_speed = 0.0
        self._controlword = self._repeats = 0
        self.emergencies: list[str] = []
        self.emergency_codes: list[int] = []
        self.last_heartbeat_s = -math.inf
        self.last_seen_s = -math.inf
        self.status = 0
        self.wheel_speed_rad_s = math.nan
        self._node.nmt.add_heartbeat_callback(self._take_heartbeat)
        self._node.emcy.add_callback(self._take_emergency)

    def bindings(self, side: str) -> list[Binding]:
        """Where this node's channels lie; `side` is left or right."""
        values, status = self._values, self._status
        found = [
            Binding(self.bus, values.id, values.signals["Wheel speed"], f"wheel_speed_{side}_rad_s"),
            Binding(self.bus, values.id, values.signals["Shaft torque"], f"shaft_torque_{side}_nm"),
            Binding(self.bus, status.id, status.signals["Torque actual value"], f"dyno_torque_{side}_nm"),
        ]
        if side == "left":
            found.append(Binding(self.bus, status.id, status.signals["Vehicle speed"], "vehicle_speed_m_s"))
        return found

    @property
    def state(self) -> str:
        """State of the drive in the words of CiA 402."""
        return self.state_of(self.status)

    @staticmethod
    def state_of(status: int) -> str:
        """What a statusword says, in the words of CiA 402."""
        return _STATE_NAMES.get(status & STATE_MASK, f"0x{status:04X}")

    @property
    def nmt_state(self) -> str:
        """The state in its last heartbeat, in words."""
        return str(self._node.nmt.state).lower()

    def in_state(self, bits: int) -> bool:
        """Whether the drive says now that it is in this state."""
        fresh = self._network.loop.clock.now_s() - self.last_seen_s < _FRESH_S
        return fresh and self.status & STATE_MASK == bits

    def write(self, index: int, subindex: int, value: float, what: str) -> None:
        """Write an object by SDO and read it back.

        Raises:
            DeviceError: no answer, a refusal, or another value than was written.
        """
        entry = self._node.sdo[index] if subindex == 0 else self._node.sdo[index][subindex]
        named = f"{what} ({_object(index, subindex)})"
        try:
            entry.raw = value
            answer = entry.raw
        except canopen.SdoCommunicationError as error:
            raise DeviceError(
                f"no answer within {SDO_TIMEOUT_S:g} s while {named} was written",
                where=self._where,
                fix="check that it is powered and on this bus",
            ) from error
        except canopen.SdoAbortedError as error:
            raise DeviceError(
                f"refused {named} = {value:g}: {abort_in_words(error.code)}",
                where=self._where,
                fix="check the value, the drive's state and its manual",
            ) from error
        sent = float(np.float32(value)) if isinstance(answer, float) else value
        if answer != sent:
            raise DeviceError(f"{what} reads back as {answer:g}, {value:g} was written", where=self._where)

    def read(self, index: int, subindex: int = 0) -> Any:
        """An object's value by SDO; None if the EDS or the node does not have it.

        Raises:
            DeviceError: no answer.
        """
        entry = self._entry(index, subindex)
        if entry is None:
            return None
        try:
            try:
                return entry.raw
            except BrokenOffError:  # a text comes in segments, each of which may be lost
                return entry.raw
        except canopen.SdoAbortedError:
            return None
        except canopen.SdoCommunicationError as error:
            raise DeviceError(
                f"no answer within {SDO_TIMEOUT_S:g} s while {_object(index, subindex)} was read",
                where=self._where,
                fix="check that it is powered and on this bus",
            ) from error

    def measured(self, name: str) -> float | None:
        """What it measures now of an object that its values PDO maps; None if it cannot be read by SDO.

        Raises:
            DeviceError: no answer.
        """
        variable = self._node.object_dictionary.names.get(name)
        if variable is None or hasattr(variable, "subindices"):
            return None
        raw = self.read(variable.index)
        signal = self._values.signals[name]
        return None if raw is None else float(raw) * signal.scale + signal.offset

    def differences(self) -> list[str]:
        """Where the device maps other objects or uses other identifiers than its EDS says; sentences.

        What the device does not let be read is taken from the EDS.

        Raises:
            DeviceError: no answer.
        """
        found = []
        for (mapping, communication, _, _), layout in zip(_PDOS, self._layouts, strict=True):
            expected = mapping_of(self._node.object_dictionary, mapping, str(self._eds))
            for subindex, value in enumerate([len(expected), *expected]):
                found.append(self._difference(mapping, subindex, value, 0xFFFF_FFFF))
            found.append(self._difference(communication, 1, layout.id, _OF_COB_ID))
        return [one for one in found if one]

    def _difference(self, index: int, subindex: int, expected: int, mask: int) -> str:
        value = self.read(index, subindex)
        if not isinstance(value, int) or value & mask == expected:
            return ""
        width = 2 if subindex == 0 else 8
        return (
            f"{_object(index, subindex)} is 0x{value:0{width}X} in the device, "
            f"0x{expected:0{width}X} in {self._eds.name}"
        )

    def _entry(self, index: int, subindex: int) -> Any | None:
        if index not in self._node.object_dictionary:
            return None
        described = self._node.object_dictionary[index]
        if not hasattr(described, "subindices"):
            return self._node.sdo[index] if subindex == 0 else None
        return self._node.sdo[index][subindex] if subindex in described.subindices else None

    def set_speed(self, speed_rad_s: float) -> None:
        """Remember the speed that the next command carries."""
        self._target_speed = speed_rad_s

    def command(self, controlword: int) -> None:
        """Send controlword and target speed by PDO, now and with some of the next `repeat`."""
        self._controlword, self._repeats = controlword, _REPEATS
        self._send_command(controlword)

    def repeat(self) -> None:
        """Send the newest command once more, unless it was repeated often enough: a frame may be lost."""
        if self._repeats > 0:
            self._repeats -= 1
            self._send_command(self._controlword)

    def _send_command(self, controlword: int) -> None:
        payload = self._command.encode(
            **{"Controlword": float(controlword), "Target velocity": self._target_speed}
        )
        data = int(payload[0]).to_bytes(8, "little")[: self._command.length]
        self._network.send_message(self._command.id, data)

    def nmt(self, state: str) -> None:
        """Ask for an NMT state."""
        self._node.nmt.state = state

    def take_block(self, block: npt.NDArray[np.void]) -> None:
        """Follow the newest PDOs of a block of this bus."""
        status, values = self._newest.of(block)
        if status is not None:
            self.last_seen_s = status[0]
            self.status = self._status.signals["Statusword"].raw(status[1])
        if values is not None:
            self.wheel_speed_rad_s = self._values.signals["Wheel speed"].value(values[1])

    @property
    def _where(self) -> str:
        return f"dyno '{self.name}' (node {self.id})"

    def _take_heartbeat(self, state: int) -> None:
        del state
        self.last_heartbeat_s = self._network.loop.clock.now_s()

    def _take_emergency(self, error: Any) -> None:
        if error.code & 0xFF00:
            self.emergency_codes.append(error.code)
            self.emergencies.append(f"EMCY 0x{error.code:04X} {error.get_desc()}".strip())
