"""The table of dynamometers on CANopen, described by an EDS."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated

from pydantic import Field

from drivers.dyno._driver import DynoDriver, DynoNodes
from drivers.dyno._node import identifiers_of, read_dyno
from drivers.table import Connections, File, LoadTable, Name
from hil.core.can.frames import most_frame_bits
from hil.core.channels import TICK_S
from hil.core.errors import BadInputError

_REAR = ("rear_left", "rear_right")
_PDOS = 4  # values and status, left and right
NodeId = Annotated[int, Field(ge=1, le=127)]


class DynoTable(LoadTable):
    """Bus, EDS and node ids of the dynamometers."""

    kind: str = "rcs-canopen"
    bus: str
    eds: File
    rear_left: NodeId = 3
    rear_right: NodeId = 4
    idle: dict[Name, NodeId] = Field({}, description="nodes that are monitored but not used")
    host_node: NodeId = 127
    emergency_stop_codes: tuple[Annotated[int, Field(ge=0x100, le=0xFFFF)], ...] = Field(
        (), strict=False, description="EMCY codes that say that the dynos' emergency stop was pressed"
    )

    @property
    def nodes(self) -> dict[str, int]:
        """Node ids on the bus by their keys."""
        idle = {f"idle.{name}": node for name, node in self.idle.items()}
        return {
            "rear_left": self.rear_left,
            "rear_right": self.rear_right,
            **idle,
            "host_node": self.host_node,
        }

    def open(self, name: str, connections: Connections) -> DynoDriver:
        """Make the driver.

        Raises:
            BadInputError: the EDS cannot be used.
        """
        del name  # there is one pair of dynos
        nodes = DynoNodes(self.rear_left, self.rear_right, dict(self.idle), self.host_node)
        wire = connections.wires[self.bus]
        return DynoDriver(
            connections.loop, wire, self.eds, nodes, connections.vehicle, self.emergency_stop_codes
        )

    def contradictions(self) -> Iterator[str]:
        """Node ids that two nodes share."""
        seen: dict[int, str] = {}
        for key, node in self.nodes.items():
            other = seen.setdefault(node, key)
            if other != key:
                yield f"{key} = {node}: is also {other}; every node on a bus has an id of its own"

    def unusable_files(self) -> Iterator[tuple[str, BadInputError]]:
        """The EDS, if it cannot be used."""
        try:
            read_dyno(self.eds, self.rear_left)
        except BadInputError as error:
            yield "eds", error

    def identifiers(self) -> Mapping[int, str]:
        """What the nodes send or hear."""
        taken: dict[int, str] = {}
        for key, node in self.nodes.items():
            taken |= identifiers_of(node, key, self._pdo_ids(node) if key in _REAR else None)
        return taken

    def bits_each_second(self) -> float:
        """SYNC and both dynos' PDOs, one each millisecond, as large as they may be."""
        return (int(most_frame_bits(0, False)) + _PDOS * int(most_frame_bits(8, False))) / TICK_S

    def described_in(self) -> dict[str, tuple[str, str]]:
        """Objects that the EDS maps."""
        found = {}
        for side, node in (("left", self.rear_left), ("right", self.rear_right)):
            of = f"of node {node}"
            found[f"wheel_speed_{side}_rad_s"] = ("eds", f"'Wheel speed' {of}")
            found[f"shaft_torque_{side}_nm"] = ("eds", f"'Shaft torque' {of}")
            found[f"dyno_torque_{side}_nm"] = ("eds", f"'Torque actual value' {of}")
        return found | {"vehicle_speed_m_s": ("eds", f"'Vehicle speed' of node {self.rear_left}")}

    def asked_by_hosts(self) -> tuple[int, ...]:
        """The host's heartbeat, NMT, commands and SDO requests."""
        rear = (self.rear_left, self.rear_right)
        commands = [self._pdo_ids(node)[1] for node in rear]
        return (0x000, 0x700 + self.host_node, *commands, *(0x600 + node for node in rear))

    def remarks(self) -> tuple[str, ...]:
        """Units of the EDS."""
        return read_dyno(self.eds, self.rear_left).remarks

    def _pdo_ids(self, node: int) -> tuple[int, int, int]:
        return _ids_in(self.eds, self.eds.stat().st_mtime_ns, node)


@functools.lru_cache(64)
def _ids_in(eds: Path, changed_ns: int, node: int) -> tuple[int, int, int]:
    """Identifiers of a node's values, command and status, as a file says them that was changed then."""
    del changed_ns
    file = read_dyno(eds, node)
    return file.values.id, file.command.id, file.status.id
