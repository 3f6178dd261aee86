"""canopen's master services in the one loop of the drivers: no threads, no sleeping."""

from __future__ import annotations

import struct
from typing import Any

import canopen
from canopen.node import RemoteNode
from canopen.sdo import SdoClient, SdoCommunicationError

from drivers.loop import BusLoop
from drivers.wire import Wire

SDO_TIMEOUT_S = 0.3


class LoopNetwork(canopen.Network):  # type: ignore[misc]
    """A network whose frames go through a `Wire` and whose waiting is done by the `BusLoop`."""

    def __init__(self, loop: BusLoop, wire: Wire) -> None:
        self.loop, self._wire = loop, wire  # canopen's constructor already subscribes
        #: What is wrong with frames that came, by identifier: too short for what CiA 301 sends there.
        self.damaged: dict[int, str] = {}
        super().__init__()

    def send_message(self, can_id: int, data: Any, remote: bool = False) -> None:
        """Send through the wire."""
        del remote
        self._wire.send(can_id, bytes(data))

    def subscribe(self, can_id: int, callback: Any) -> None:
        """Listen through the loop; canopen's own notify then spreads the frame."""
        super().subscribe(can_id, callback)
        if can_id:
            self.loop.on_frame(self._wire, can_id, self._forward)

    def _forward(self, frame_id: int, data: bytes, time_s: float) -> None:
        try:
            self.notify(frame_id, bytearray(data), time_s)
        except struct.error:  # the library unpacks what it expects
            self.damaged[frame_id] = f"frame 0x{frame_id:03X} with {len(data)} bytes: too short for CANopen"


class LoopNode(RemoteNode):  # type: ignore[misc]
    """A remote node whose SDO client steps the loop while it waits."""

    def add_sdo(self, rx_cobid: int, tx_cobid: int) -> Any:
        """The client of one SDO channel."""
        client = _LoopSdoClient(rx_cobid, tx_cobid, self.object_dictionary)
        self.sdo_channels.append(client)
        if self.has_network():
            self.network.subscribe(tx_cobid, client.on_response)
        return client


class _LoopSdoClient(SdoClient):  # type: ignore[misc]
    def read_response(self) -> Any:
        """Step the loop until the answer is there."""
        if not self.network.loop.wait_for(lambda: not self.responses.empty(), SDO_TIMEOUT_S):
            raise SdoCommunicationError("No SDO response received")
        return super().read_response()
