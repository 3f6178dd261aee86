"""One dynamometer as a CANopen node: NMT, heartbeat, SDO, PDO, EMCY. Written against the EDS."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import canopen
import numpy as np
import numpy.typing as npt
from canopen.objectdictionary import SIGNED_TYPES, ODVariable

from hil.core.can.eds import ObjectDictionary, identifier_of, layout_of_pdo, read_eds
from hil.core.can.signals import FrameLayout, in_units
from hil.plant.closed_loop import drive as law
from sim_backend.rcs._objects import INVALID_VALUE, PowerStates, ServedNode, State, check_value

_OPERATIONAL = 5
_MODES = {3: law.SPEED, 4: law.TORQUE, -1: law.VEHICLE}
_RUNAWAY_RAD_S2 = 400.0
_NO_MODE = 0  # CiA 402: "no mode assigned", which the EDS has as default; the drive turns free
_EMCY_HEARTBEAT_LOST = 0x8130
_SYNC_ID, _SYNC_PRODUCER = 0x80, 1 << 30
_SYNC_PERIODS_US = (0, 1000)  # the bench has one sample time
_HIGHEST_NODE_ID = 127
_FIRST_SERIAL = 1000
_PDO_PARAMETERS = range(0x1400, 0x1C00)  # they can be read and written back; what is mapped stays
# Vehicle model (0x2000) by subindex: what a vehicle can have
_VEHICLE_RANGES = {
    1: (1e-3, 1e6),  # inertia, kg m2
    2: (0.0, 1e6),  # rolling resistance, N m
    3: (0.0, 1e6),  # aerodynamic resistance, N m s2/rad2
    4: (0.0, 1.0 - 1e-6),  # slip
    5: (1e-3, 10.0),  # wheel radius, m
    6: (-150.0, 150.0),  # initial speed, m/s
}
# What the emulation reads or shows: index and subindex
_OBJECTS = (
    (0x1005, 0),
    (0x1006, 0),
    (0x1014, 0),
    (0x1016, 1),
    (0x1017, 0),
    (0x6040, 0),
    (0x6041, 0),
    (0x6060, 0),
    (0x6061, 0),
    (0x6071, 0),
    (0x6083, 0),
    (0x60FF, 0),
)


class _Timer:
    """A cyclic message in virtual time."""

    def __init__(self, frame_id: int, data: bytes, period_s: float, start_s: float) -> None:
        self.frame_id, self.data, self.period_s = frame_id, bytes(data), period_s
        self.due_s = start_s + period_s

    def stop(self) -> None:
        self.period_s = float("inf")
        self.due_s = float("inf")

    def update(self, data: Any) -> None:
        self.data = bytes(data)


class _Network(canopen.Network):  # type: ignore[misc]
    """canopen's services on the simulated wire; heartbeats run in virtual time."""

    def __init__(self, send: Callable[[int, bytes], None]) -> None:
        super().__init__()
        self.time_s = 0.0
        self.timers: list[_Timer] = []
        self._deliver = send

    def send_message(self, can_id: int, data: Any, remote: bool = False) -> None:
        del remote
        self._deliver(can_id, bytes(data))

    def send_periodic(self, can_id: int, data: Any, period: float, remote: bool = False) -> _Timer:
        del remote
        timer = _Timer(can_id, bytes(data), period, self.time_s)
        self.timers = [t for t in self.timers if t.due_s != float("inf")] + [timer]
        return timer


_UNITS = {
    "Target velocity": "rad/s",
    "Wheel speed": "rad/s",
    "Shaft torque": "N m",
    "Torque actual value": "N m",
    "Vehicle speed": "m/s",
}


def read_node(
    eds: Path, node_id: int
) -> tuple[ObjectDictionary, tuple[FrameLayout, FrameLayout, FrameLayout]]:
    """The dictionary of an emulated node, and the layouts of its command, values and status PDOs.

    Raises:
        BadInputError: not an EDS, or it lacks an object or a mapping that the emulation uses.
    """
    dictionary = read_eds(eds, node_id, _OBJECTS, floats=tuple((0x2000, i) for i in range(1, 7)))
    command = ("Controlword", "Target velocity", "Target torque")
    status = ("Statusword", "Vehicle speed", "Torque actual value")
    where = str(eds)

    def layout(mapping: int, communication: int, usual: int, needed: tuple[str, ...]) -> FrameLayout:
        identifier = identifier_of(dictionary, communication, usual + node_id, where)
        return in_units(layout_of_pdo(dictionary, mapping, identifier, needed, where), _UNITS, where, [])

    layouts = (
        layout(0x1600, 0x1400, 0x200, command),
        layout(0x1A00, 0x1800, 0x180, ("Wheel speed", "Shaft torque")),
        layout(0x1A01, 0x1801, 0x280, status),
    )
    return dictionary, layouts


class DynoNode:
    """A node and its drive; `row` is what the compiled law of the drive reads."""

    def __init__(
        self, node_id: int, eds: Path, send: Callable[[int, bytes], None], row: npt.NDArray[np.float64]
    ) -> None:
        self.id = node_id
        self.row = row
        self.power = PowerStates()
        self._powered = True
        self._runaway_rad_s: float | None = None
        self._network = _Network(send)
        self._dictionary, (self._command, self.values, self.status) = read_node(eds, node_id)
        self._node: Any = ServedNode(node_id, self._dictionary)
        self._node.associate_network(self._network)
        self._node.add_write_callback(self._written)
        self._boot()
        self._host_heard_s = float("inf")
        self._host_heartbeat, self._host_limit_s = -1, float("inf")
        self._follow()

    def _boot(self) -> None:
        """Boot-up message, then pre-operational; nothing is configured."""
        self._give_serial_number()
        self._node.nmt.send_command(0)
        self._node.nmt.send_command(128)

    def reset(self) -> None:
        """Boot again: the drive gives no torque, what was configured is forgotten."""
        self.power = PowerStates()
        self._network.timers.clear()
        self._node.data_store.clear()
        self._host_heard_s = float("inf")
        self._boot()
        self._follow()

    def fail(self, code: int) -> None:
        """The drive goes to fault and tells why, by an EMCY with this error code (CiA 301)."""
        self.power.fail()
        self.tell(code)
        self._follow()

    def run_away(self, speed_rad_s: float) -> None:
        """Drive to a speed whatever is asked for."""
        self._runaway_rad_s = speed_rad_s
        self._follow()

    def tell(self, code: int) -> None:
        """Send an EMCY with this error code."""
        self._node.emcy.send(code, 0x01)

    def _give_serial_number(self) -> None:
        """Each node has another, in the identity object (CiA 301) if the EDS has it; its EDS says 0."""
        identity = self._dictionary.get(0x1018)
        if identity is not None and 4 in getattr(identity, "subindices", {}):
            serial = identity[4].encode_raw(_FIRST_SERIAL + self.id)
            self._node.data_store.setdefault(0x1018, {})[4] = serial

    @property
    def operational(self) -> bool:
        """Whether NMT lets the node send PDOs."""
        return self._powered and bool(self._node.nmt._state == _OPERATIONAL)

    @property
    def sync_period_s(self) -> float:
        """Period of the SYNC that this node gives; 0 if it gives none."""
        produces = self._powered and self.number(0x1005) & _SYNC_PRODUCER
        return self.number(0x1006) * 1e-6 if produces else 0.0

    def receive(self, frame_id: int, data: bytes, time_s: float) -> None:
        """Take one frame from the bus."""
        self._network.time_s = time_s
        if not self._powered:
            return
        if frame_id == self._host_heartbeat:
            self._host_heard_s = time_s
            return
        if frame_id == self._command.id:
            if self.operational and len(data) == self._command.length:
                self._take_command(int.from_bytes(data, "little"))
        else:
            self._network.notify(frame_id, bytearray(data), time_s)
        self._follow()

    def pass_time(self, time_s: float) -> None:
        """Send heartbeats that are due; go to fault by itself when the host has fallen silent."""
        self._network.time_s = time_s
        if not self._powered:
            return
        for timer in self._network.timers:
            if time_s >= timer.due_s:
                timer.due_s += timer.period_s
                self._network.send_message(timer.frame_id, timer.data)
        silent = time_s - self._host_heard_s > self._host_limit_s
        if silent and self.power.state is not State.FAULT:
            if self.power.state is not State.SWITCH_ON_DISABLED:
                self.power.fail()
                self._node.emcy.send(_EMCY_HEARTBEAT_LOST, 0x11)
                self._follow()
            self._host_heard_s = float("inf")

    def switch_off(self) -> None:
        """Lose power: no frame is sent or heard any more, the drive gives no torque."""
        self._powered = False
        self.power.fail()
        self._follow()

    def number(self, index: int, subindex: int = 0) -> Any:
        """Present value of an object of the dictionary."""
        entry = self._dictionary[index]
        variable = entry if subindex == 0 and not hasattr(entry, "subindices") else entry[subindex]
        return variable.decode_raw(self._node.get_data(index, subindex))

    def show(self, index: int, value: int) -> None:
        """Update an object so that SDO reads see it."""
        variable = self._dictionary[index]
        self._node.data_store.setdefault(index, {})[0] = variable.encode_raw(value)

    def measure(
        self, wheel_speed_rad_s: float, shaft_torque_nm: float, vehicle_speed_m_s: float, torque_nm: float
    ) -> None:
        """What SDO reads of measured values see; an EDS need not have all of them."""
        measured = {
            0x2100: shaft_torque_nm,
            0x2101: wheel_speed_rad_s,
            0x2102: vehicle_speed_m_s,
            0x606C: wheel_speed_rad_s,
            0x6077: torque_nm,
        }
        for index, value in measured.items():
            variable = self._dictionary.get(index)
            if isinstance(variable, ODVariable) and variable.data_type in SIGNED_TYPES:
                largest = (1 << (len(variable) - 1)) - 1
                self.show(index, max(-largest, min(largest, round(value / variable.factor))))

    def preset(self, index: int, subindex: int, value: float) -> None:
        """Value of a float object before the host has written it."""
        variable = self._dictionary[index][subindex]
        self._node.data_store.setdefault(index, {})[subindex] = variable.encode_raw(value)

    def _take_command(self, payload: int) -> None:
        signals = self._command.signals
        self.row[law.TARGET_SPEED] = signals["Target velocity"].value(payload)
        self.row[law.TARGET_TORQUE] = signals["Target torque"].value(payload)
        if self._runaway_rad_s is None:  # else it does not listen
            self.power.command(signals["Controlword"].raw(payload))
        for index, name in ((0x6040, "Controlword"), (0x60FF, "Target velocity"), (0x6071, "Target torque")):
            data = signals[name].raw(payload).to_bytes(signals[name].length // 8, "little")
            self._node.data_store.setdefault(index, {})[0] = data

    def _written(self, index: int, subindex: int, od: Any, data: bytes) -> None:
        self._refuse(index, subindex, od.decode_raw(data), data)
        if index == 0x6040:
            self.power.command(od.decode_raw(data))
        elif index == 0x60FF:
            self.row[law.TARGET_SPEED] = od.decode_raw(data) * od.factor
        elif index == 0x6071:
            self.row[law.TARGET_TORQUE] = od.decode_raw(data) * od.factor

    def _refuse(self, index: int, subindex: int, value: Any, data: bytes) -> None:
        """What this drive does not do, beyond what its EDS says: it is refused, not taken and ignored."""
        wrong = False
        if index == 0x1005:
            wrong = value & ~_SYNC_PRODUCER != _SYNC_ID
        elif index == 0x1006:
            wrong = value not in _SYNC_PERIODS_US
        elif index == 0x1016:
            wrong = value >> 16 > _HIGHEST_NODE_ID
        elif index == 0x6060:
            wrong = value not in (*_MODES, _NO_MODE)
        elif index in _PDO_PARAMETERS:
            wrong = bytes(data) != self._node.get_data(index, subindex)
        elif index == 0x2000 and subindex in _VEHICLE_RANGES:
            check_value(value, *_VEHICLE_RANGES[subindex])
        if wrong:
            raise canopen.SdoAbortedError(INVALID_VALUE)

    def _follow(self) -> None:
        """Bring the drive in line with power state, mode of operation and heartbeat supervision."""
        watch = self.number(0x1016, 1)
        self._host_heartbeat = 0x700 + (watch >> 16 & 0x7F) if watch & 0xFFFF else -1
        self._host_limit_s = (watch & 0xFFFF) * 1e-3 or float("inf")
        mode = self.number(0x6060)
        self.show(0x6061, mode)
        self.show(0x6041, self.power.statusword)
        self.row[law.ACCELERATION] = self.number(0x6083) * self._dictionary[0x6083].factor
        enabled = self.power.state is State.OPERATION_ENABLED
        wanted = _MODES.get(mode, law.FREE) if enabled else law.FREE
        if self.power.state is State.QUICK_STOP_ACTIVE:
            wanted, self.row[law.TARGET_SPEED] = law.SPEED, 0.0
        if self._runaway_rad_s is not None:
            wanted, self.row[law.TARGET_SPEED] = law.SPEED, self._runaway_rad_s
            self.row[law.ACCELERATION] = _RUNAWAY_RAD_S2
        self.row[law.MODE] = wanted
