"""Error frames as SocketCAN has them (Linux, include/uapi/linux/can/error.h): made, and put into words."""

from __future__ import annotations

from collections.abc import Sequence

import can

# Error classes, in the identifier
TRANSMIT_TIMEOUT, LOST_ARBITRATION, CONTROLLER, PROTOCOL = 0x01, 0x02, 0x04, 0x08
TRANSCEIVER, NO_ACKNOWLEDGE, BUS_OFF, BUS_ERROR, RESTARTED = 0x10, 0x20, 0x40, 0x80, 0x100
# State of the controller, in byte 1
RECEIVE_OVERFLOW, TRANSMIT_OVERFLOW = 0x01, 0x02
WARNING, PASSIVE, ACTIVE_AGAIN = 0x0C, 0x30, 0x40  # both of receive and transmit
_LENGTH = 8
_COUNTERS = (6, 7)  # bytes of the transmit and the receive error counter


def frame(stamp: float, kind: int, state: int, *, received: int = 0, sent: int = 0) -> can.Message:
    """An error frame of a class, a controller state and two error counters."""
    data = bytearray(_LENGTH)
    data[1], data[_COUNTERS[0]], data[_COUNTERS[1]] = state, min(sent, 255), min(received, 255)
    return can.Message(stamp, kind, True, is_error_frame=True, data=data, dlc=_LENGTH)


def joined(stamp: float, ancillary: Sequence[tuple[int, int]]) -> can.Message | None:
    """One error frame of several classes and states; None for none."""
    kind = state = 0
    for one, other in ancillary:
        kind, state = kind | one, state | other
    return frame(stamp, kind, state) if kind else None


def fault(message: can.Message) -> str:
    """What an error frame says that a run cannot go on with; '' if it can."""
    kind, data = message.arbitration_id, bytes(message.data)
    state = data[1] if len(data) > 1 else 0
    counted = ""
    if len(data) == _LENGTH and any(data[i] for i in _COUNTERS):
        counted = f", error counters: transmit {data[_COUNTERS[0]]}, receive {data[_COUNTERS[1]]}"
    if kind & BUS_OFF:
        return f"bus-off: after too many errors the adapter is disconnected from the bus{counted}"
    if kind & TRANSMIT_TIMEOUT:
        return "the adapter's driver says that a frame could not be sent in time"
    if kind & CONTROLLER and state & PASSIVE:
        return f"error-passive: frames are damaged, or no node acknowledges them{counted}"
    if kind & CONTROLLER and state & TRANSMIT_OVERFLOW:
        return "the transmit queue is full: the adapter refuses frames"
    return ""


def remark(message: can.Message) -> str:
    """What an error frame says that is worth a line in the log; '' if nothing is."""
    kind, data = message.arbitration_id, bytes(message.data)
    state = data[1] if len(data) > 1 else 0
    if kind & RESTARTED:
        return "the adapter is connected to the bus again after bus-off"
    if kind & CONTROLLER and state & RECEIVE_OVERFLOW:
        return "the adapter lost frames: its receive buffer was full"
    if kind & CONTROLLER and state & WARNING:
        return "error warning: 96 errors or more were counted"
    return ""
