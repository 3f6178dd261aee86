"""canopen's master services in the one loop of the drivers: no threads, no sleeping."""

from __future__ import annotations

import logging
import struct
from typing import Any

import canopen
from canopen.node import RemoteNode
from canopen.sdo import SdoAbortedError, SdoClient, SdoCommunicationError

from drivers.loop import BusLoop
from drivers.wire import Wire

#: For an answer to an SDO request, whether it is asked for once or several times.
SDO_TIMEOUT_S = 0.3
#: After so long without an answer the same is asked again: a frame may be lost, and the object is the same.
_ASKED_AGAIN_S = 0.05

_SPECIFIER = 0xE0  # bits of an SDO frame's first byte that say what it is
_WRITE, _READ, _ABORT = 0x20, 0x40, 0x80  # requests that begin a transfer; its end
_NEXT_READ, _NEXT_WRITE = 0x60, 0x00  # requests for a further segment
_ANSWERS = {_WRITE: 0x60, _READ: 0x40, _NEXT_READ: 0x00, _NEXT_WRITE: 0x20}
_WHOLE = 8
_TIMED_OUT = 0x05040000
# CiA 301, table 22, as what to look at
_ABORTS = {
    0x05030000: "its answer and the request do not alternate",
    0x05040000: "it waited too long for the transfer to go on",
    0x05040001: "it does not know the request",
    0x05040005: "it is out of memory",
    0x06010000: "the object does not support this access",
    0x06010001: "the object can only be written",
    0x06010002: "the object can only be read",
    0x06020000: "it has no such object",
    0x06040041: "the object cannot be mapped to a PDO",
    0x06040042: "the mapped objects are longer than a PDO",
    0x06040043: "the value does not go with its other parameters",
    0x06040047: "the value does not go with its state inside",
    0x06060000: "its hardware has a fault",
    0x06070010: "the object has another length or type",
    0x06070012: "the object is shorter",
    0x06070013: "the object is longer",
    0x06090011: "the object has no such subindex",
    0x06090030: "the value is out of its range",
    0x06090031: "the value is above its range",
    0x06090032: "the value is below its range",
    0x06090036: "its largest value would be below its smallest",
    0x060A0023: "a required resource is not available",
    0x08000000: "it gives no reason",
    0x08000020: "it cannot store the value",
    0x08000021: "it is under local control",
    0x08000022: "it refuses it in its present state",
    0x08000023: "it has no dictionary of its objects",
    0x08000024: "it has no data",
}

# What the library says of its own (transfers it gives up, frames it does not know) is stated by the drivers.
logging.getLogger("canopen").addHandler(logging.NullHandler())
logging.getLogger("canopen").propagate = False


class BrokenOffError(SdoCommunicationError):  # type: ignore[misc]
    """A transfer that had started was not continued: as a whole it can be tried again."""


def abort_in_words(code: int) -> str:
    """Why a node refused an object, by the code of its SDO abort."""
    return f"{_ABORTS.get(code, 'it gives a manufacturer-specific reason')} (SDO abort 0x{code:08X})"


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
    """A client that asks again within its deadline, and takes for an answer what answers this very request.

    Only what begins a transfer is repeated: it names its object, and may come twice. A segment may not.
    """

    def request_response(self, sdo_request: Any) -> bytes:
        """The node's answer.

        Raises:
            SdoAbortedError: it refuses.
            SdoCommunicationError: none within `SDO_TIMEOUT_S`; `BrokenOffError` of a segment.
        """
        request, loop = bytes(sdo_request), self.network.loop
        self._forget_answers()
        begins = _begins(request)
        until_s = loop.clock.now_s() + SDO_TIMEOUT_S
        while (left_s := until_s - loop.clock.now_s()) > 0.0:
            self.send_request(request)
            answer = self._awaited(request, min(_ASKED_AGAIN_S, left_s) if begins else left_s)
            if answer is not None:
                return answer
        if begins:
            raise SdoCommunicationError("no answer")
        self.abort(_TIMED_OUT)
        raise BrokenOffError("no answer")

    def abort(self, abort_code: int = 0x08000000) -> None:
        """Give up a transfer, without the library's line in the log."""
        self.send_request(struct.pack("<B3xL", _ABORT, abort_code))

    def _awaited(self, request: bytes, within_s: float) -> bytes | None:
        """The answer to this request if it comes in time; what answers others is dropped."""
        loop = self.network.loop
        until_s = loop.clock.now_s() + within_s
        while (left_s := until_s - loop.clock.now_s()) > 0.0:
            if not loop.wait_for(lambda: not self.responses.empty(), left_s):
                break
            answer = self.responses.get()
            if not _answers(answer, request):
                continue
            if answer[0] == _ABORT:
                raise SdoAbortedError(int.from_bytes(answer[4:8], "little"))
            return bytes(answer)
        return None

    def _forget_answers(self) -> None:
        while not self.responses.empty():
            self.responses.get()


def _answers(answer: bytes, request: bytes) -> bool:
    """Whether a frame answers a request: the same object, and the answer that belongs to its kind."""
    if len(answer) < _WHOLE:
        return False
    if _begins(request) and answer[1:4] != request[1:4]:
        return False
    return answer[0] == _ABORT or answer[0] & _SPECIFIER == _ANSWERS.get(request[0] & _SPECIFIER)


def _begins(request: bytes) -> bool:
    """Whether a request begins a transfer: then it names its object."""
    return request[0] & _SPECIFIER in (_WRITE, _READ)
