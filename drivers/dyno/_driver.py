"""The RC-S style dynamometers of an axle, as one device. The RC-S's own protocol would live here too."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Collection
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt

from drivers.device import Examined
from drivers.dyno._canopen import LoopNetwork
from drivers.dyno._examination import OTHER_PDOS, examine, identify
from drivers.dyno._node import (
    ENABLED,
    FAULT,
    HEARTBEAT_LOST_S,
    READY,
    SWITCH_ON_DISABLED,
    SWITCHED_ON,
    DynoNode,
)
from drivers.frame_source import CountedBy, FrameSource
from drivers.loop import BusLoop
from drivers.table import VehicleParameters
from drivers.wire import Wire
from hil.core.channels import TICK_S
from hil.core.errors import BenchError, DeviceError

SPEED_MODE, VEHICLE_MODE = 3, -1
_SHUTDOWN, _SWITCH_ON, _ENABLE, _DISABLE_VOLTAGE, _FAULT_RESET = 0x06, 0x07, 0x0F, 0x00, 0x80
_HOST_SILENCE_MS = 200
_NODE_HEARTBEAT_MS = 100
_SYNC_PERIOD_US = 1000
_SYNC_PRODUCER = 1 << 30
SYNC = 0x80
_STATE_TIMEOUT_S = 0.5
_ASKED_AGAIN_S = 0.05
_ACCELERATION_UNIT_RAD_S2 = 1e-4


@dataclass(frozen=True)
class DynoNodes:
    """Node ids on the bus; the host takes part as a node whose heartbeat the dynos watch."""

    rear_left: int
    rear_right: int
    idle: dict[str, int] = field(default_factory=dict)
    host: int = 127


class DynoDriver:
    """Rear left and right dynamometer together, a `WheelLoad`; front ones are watched and left idle."""

    name = "dynos"
    heartbeat_s = 0.05
    safe_within_s = 0.5

    def __init__(
        self,
        loop: BusLoop,
        wire: Wire,
        eds: Path,
        nodes: DynoNodes,
        vehicle: VehicleParameters,
        stop_codes: Collection[int] = (),
    ) -> None:
        self._loop, self._wire, self._host, self._stop_codes = loop, wire, nodes.host, stop_codes
        self.vehicle = vehicle
        self._network = network = LoopNetwork(loop, wire)
        self.left = DynoNode(network, wire.name, nodes.rear_left, "rear left", eds)
        self.right = DynoNode(network, wire.name, nodes.rear_right, "rear right", eds)
        self.rear = (self.left, self.right)
        self.idle = [DynoNode(network, wire.name, i, name, eds) for name, i in nodes.idle.items()]
        self._watched: list[DynoNode] = [*self.rear, *self.idle]
        self._other_pdos: list[tuple[DynoNode, str]] | None = None
        self.missing: list[str] = []  # idle nodes that were not there when it came up
        # Both measure at the SYNC, and send what they measured after it.
        sync = CountedBy(wire.name, SYNC, "SYNC", opens=True)
        source = FrameSource([*self.left.bindings("left"), *self.right.bindings("right")], TICK_S, sync)
        self.sources = (source,)
        loop.on_block(self._take_block)
        loop.on_block(source.take)

    def come_up(self) -> None:
        """Bring the nodes to operation: supervision, SYNC, vehicle model. The drives stay without torque.

        An idle node that is missing keeps no one from anything: it stands in `missing`.

        Raises:
            BenchError: a rear node is missing, or one does not answer or refuses a value.
        """
        everyone = [*self.rear, *self.idle]
        self._loop.wait_for(lambda: all(n.last_heartbeat_s > -np.inf for n in everyone), 3.0)
        silent = [n for n in everyone if n.last_heartbeat_s == -np.inf]
        self._watched = [n for n in everyone if n not in silent]
        self.missing = [f"{n.name} (node {n.id})" for n in silent if n in self.idle]
        if any(n in self.rear for n in silent):
            raise BenchError(
                f"no heartbeat from {', '.join(f'{n.name} (node {n.id})' for n in silent)}",
                where=f"bus '{self._wire.name}'",
                fix="switch the dyno controller on, check node ids in the bench file",
            )
        self._refuse_other_pdos()
        for node in self.rear:
            node.write(0x1017, 0, _NODE_HEARTBEAT_MS, "heartbeat time")
            node.write(0x1016, 1, self._host << 16 | _HOST_SILENCE_MS, "watch on the host's heartbeat")
            self._write_vehicle(node)
        self.left.write(0x1006, 0, _SYNC_PERIOD_US, "SYNC period")
        self.left.write(0x1005, 0, _SYNC_PRODUCER | SYNC, "SYNC producer")

        def start() -> None:
            for node in self.rear:
                node.nmt("OPERATIONAL")

        if not self._asked_until(start, lambda: all(n.last_seen_s > -np.inf for n in self.rear)):
            raise BenchError("the rear dynos send no measured values", where=f"bus '{self._wire.name}'")

    def enable(self, acceleration_rad_s2: float) -> None:
        """Switch both drives on in speed mode at their present speed.

        Raises:
            BenchError: a drive does not reach 'operation enabled'.
        """
        for node in self.rear:
            node.write(0x6083, 0, round(acceleration_rad_s2 / _ACCELERATION_UNIT_RAD_S2), "acceleration")
            node.write(0x6060, 0, SPEED_MODE, "mode of operation")
            node.set_speed(node.wheel_speed_rad_s)
        if any(n.in_state(FAULT) for n in self.rear):
            self._all(_FAULT_RESET, SWITCH_ON_DISABLED)
        self._all(_SHUTDOWN, READY)
        self._all(_SWITCH_ON, SWITCHED_ON)
        self._all(_ENABLE, ENABLED)

    def hold_speed(self, speed_rad_s: float) -> None:
        """Ramp both wheels to a speed (rad/s) and hold it there; returns at once."""
        for node in self.rear:
            node.write(0x6060, 0, SPEED_MODE, "mode of operation")
            node.set_speed(speed_rad_s)
            node.command(_ENABLE)

    def set_slip(self, slip: float) -> None:
        """Have the vehicle slip by this share of its wheels' speed from now on."""
        for node in self.rear:
            node.write(0x2000, 4, slip, "slip")

    def release_vehicle(self, initial_speed_m_s: float) -> None:
        """Simulate the vehicle from now on, starting at a speed in m/s."""
        self.left.write(0x2000, 6, initial_speed_m_s, "initial vehicle speed")
        for node in self.rear:
            node.write(0x6060, 0, VEHICLE_MODE, "mode of operation")

    @property
    def wheel_speed_rad_s(self) -> float:
        """Mean of both wheels, newest value."""
        return 0.5 * (self.left.wheel_speed_rad_s + self.right.wheel_speed_rad_s)

    def make_safe(self) -> None:
        """Tell both drives to give no torque; returns at once."""
        for node in self.rear:
            node.command(_DISABLE_VOLTAGE)

    def is_safe(self) -> bool:
        """Whether both drives say that they give no torque, and say so now."""
        return all(n.in_state(SWITCH_ON_DISABLED) or n.in_state(FAULT) for n in self.rear)

    def troubles(self) -> list[str]:
        """What is wrong now: faults, lost heartbeats; emergencies and damaged frames since the start."""
        now_s = self._loop.clock.now_s()
        found = []
        for node in self._watched:
            if now_s - node.last_heartbeat_s > HEARTBEAT_LOST_S:
                found.append(f"{node.name}: heartbeat lost")
            found += [f"{node.name}: {text}" for text in node.emergencies]
        found += [f"{node.name}: drive in fault" for node in self.rear if node.in_state(FAULT)]
        return found + list(self._network.damaged.values())

    @property
    def emergency(self) -> str:
        """The EMCY of a node that says that its emergency stop was pressed; empty if none does."""
        for node in self._watched:
            for code, text in zip(node.emergency_codes, node.emergencies, strict=True):
                if code in self._stop_codes:
                    return f"{node.name}: {text}"
        return ""

    def _all(self, controlword: int, state: int) -> None:
        def command() -> None:
            for node in self.rear:
                node.command(controlword)

        if not self._asked_until(command, lambda: all(n.in_state(state) for n in self.rear)):
            states = ", ".join(f"{n.name} is in '{n.state}'" for n in self.rear)
            raise BenchError(
                f"controlword 0x{controlword:02X} did not change the state of the drives: {states}",
                where=f"bus '{self._wire.name}'",
                fix="reset the dyno controller and check its fault list",
            )

    def _asked_until(self, ask: Callable[[], None], reached: Callable[[], bool]) -> bool:
        """Ask again and again, as a frame may be lost, until it is so; False if it is not in time."""
        until_s = self._loop.clock.now_s() + _STATE_TIMEOUT_S
        while (left_s := until_s - self._loop.clock.now_s()) > 0.0:
            ask()
            if self._loop.wait_for(reached, min(_ASKED_AGAIN_S, left_s)):
                return True
        return False

    def _write_vehicle(self, node: DynoNode) -> None:
        v = self.vehicle
        values = (v.inertia_kg_m2, v.rolling_nm, v.aero_nms2_rad2, v.slip, v.wheel_radius_m)
        names = ("vehicle inertia", "rolling resistance", "aerodynamic resistance", "slip", "wheel radius")
        for subindex, (value, name) in enumerate(zip(values, names, strict=True), 1):
            if value is not None:
                node.write(0x2000, subindex, value, name)

    def beat(self) -> None:
        """The host's heartbeat, which the dynos watch; and the last requests, which may be lost."""
        self._wire.send(0x700 + self._host, b"\x05")
        for node in self.rear:
            node.repeat()

    def close(self) -> None:
        """Nothing of its own is open."""

    def identify(self) -> dict[str, str]:
        """Name, versions and serial number of each node that answers, as far as the EDS has them."""
        found = identify([*self.rear, *self.idle])
        with contextlib.suppress(DeviceError):  # who does not answer is missed when it is to come up
            self._other_pdos = self._read_pdos()
        return found

    def _read_pdos(self) -> list[tuple[DynoNode, str]]:
        """Where a device's PDOs are not those of its EDS."""
        return [(node, text) for node in self.rear for text in node.differences()]

    def _refuse_other_pdos(self) -> None:
        """Raises:
        BenchError: a device sends or takes other values than its EDS says: object, and both values.
        """
        found = self._read_pdos() if self._other_pdos is None else self._other_pdos
        if found:
            node, text = found[0]
            raise BenchError(text, where=f"dyno '{node.name}' (node {node.id})", fix=OTHER_PDOS)

    def examine(self, *, ask: bool) -> Examined:
        """Who is there, and what each says of itself; reads objects, writes none."""
        return examine(self._loop, self._wire, self.rear, self.idle, ask=ask)

    def _take_block(self, bus: str, block: npt.NDArray[np.void]) -> None:
        if bus == self._wire.name:
            for node in self.rear:
                node.take_block(block)
