"""What is known of a bus while it is used: adapter states, SocketCAN's error frames, Linux' counters.

Error frames are as in Linux, include/uapi/linux/can/error.h.
"""

from __future__ import annotations

import json
import logging
import subprocess
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

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


_WITHIN_S = 2.0


@dataclass(frozen=True)
class Link:
    """A CAN interface as `ip -details -statistics link show` tells it.

    Attributes:
        up: whether it has been brought up.
        state: ERROR-ACTIVE, ERROR-WARNING, ERROR-PASSIVE, BUS-OFF, STOPPED; '' for one without a controller.
        bit_rate: bit/s; None for one without a controller (vcan).
        transmit_errors, receive_errors: the controller's error counters; None if it does not tell them.
        bus_errors, restarts: since the interface was made.
        listen_only: whether it acknowledges nothing, and sends nothing.
        dropped: received frames that the kernel had no room for.
    """

    up: bool
    state: str = ""
    bit_rate: int | None = None
    transmit_errors: int | None = None
    receive_errors: int | None = None
    bus_errors: int = 0
    restarts: int = 0
    listen_only: bool = False
    dropped: int = 0


def link_of(channel: str) -> Link | None:
    """The interface now; None where Linux' `ip` is not there or does not know it."""
    command = ["ip", "-details", "-statistics", "-json", "link", "show", "dev", channel]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=_WITHIN_S, check=True)
    except (OSError, subprocess.SubprocessError):
        return None
    return link_from_json(done.stdout)


def link_from_json(text: str) -> Link | None:
    """The interface that `ip -json` describes; None if it describes none."""
    try:
        described = json.loads(text)[0]
    except (ValueError, LookupError, TypeError):
        return None
    info: dict[str, Any] = described.get("linkinfo", {})
    can, counts = info.get("info_data", {}), info.get("info_xstats", {})
    counters = can.get("berr_counter", {})
    return Link(
        up="UP" in described.get("flags", ()),
        state=str(can.get("state", "")),
        bit_rate=can.get("bittiming", {}).get("bitrate"),
        transmit_errors=counters.get("tx"),
        receive_errors=counters.get("rx"),
        bus_errors=counts.get("bus_error", 0),
        restarts=counts.get("restarts", 0),
        listen_only="LISTEN-ONLY" in can.get("ctrlmode", ()),
        dropped=described.get("stats64", {}).get("rx", {}).get("dropped", 0),
    )


_LOG = logging.getLogger(__name__)

_LOOK_EVERY_S = 0.05
#: Interfaces whose error frames are SocketCAN's; those of others say only that there was one.
_LINUX = frozenset({"socketcan", "socketcand", "gs_usb", "slcan"})
#: Interfaces whose `state` is asked of the controller; that of others is what it was once set to.
_ASKABLE = frozenset({"etas", "ixxat", "systec"})
# PCAN-Basic's status of a channel (PCANBasic.h)
_PCAN = {
    0x00010: "bus-off: after too many errors the adapter is disconnected from the bus",
    0x40000: "error-passive: frames are damaged, or no node acknowledges them",
    0x00001: "the transmit queue is full: the adapter refuses frames",
    0x00080: "the transmit queue is full: the adapter refuses frames",
}
_MANY = 100


class BusHealth:
    """Looks at one bus; every fault is reported once."""

    def __init__(self, name: str, interface: str = "", bus: can.BusABC | None = None) -> None:
        self._name, self._interface = name, interface
        self._ask = _questions(interface, bus)
        self._look_s = float("-inf")
        self._told: set[str] = set()
        self._new: list[str] = []
        self._error_frames = 0
        self._remarks: list[str] = []

    @property
    def remarks(self) -> list[str]:
        """What was seen that ends no run, each once."""
        counted = [f"{self._error_frames} error frames"] if self._error_frames else []
        return self._remarks + counted

    def take(self, message: can.Message) -> None:
        """Take an error frame."""
        if self._interface in _LINUX:
            self._tell(fault(message))
            self._remark(remark(message))
        else:
            self._error_frames += 1
            if self._error_frames == 1 or self._error_frames % _MANY == 0:
                _LOG.warning("bus '%s': %d error frames so far", self._name, self._error_frames)

    def new_faults(self, now_s: float) -> list[str]:
        """What has been found since the last call that a run cannot go on with.

        Raises:
            CanError: the adapter does not answer.
        """
        if self._ask is not None and now_s - self._look_s >= _LOOK_EVERY_S:
            self._look_s = now_s
            self._tell(self._ask())
        new, self._new = self._new, []
        return new

    def _tell(self, fault: str) -> None:
        kind = fault.partition(":")[0]
        if fault and kind not in self._told:
            self._told.add(kind)
            self._new.append(fault)

    def _remark(self, text: str) -> None:
        if text and text not in self._told:
            self._told.add(text)
            self._remarks.append(text)
            _LOG.warning("bus '%s': %s", self._name, text)


def _questions(interface: str, bus: can.BusABC | None) -> Callable[[], str] | None:
    """How to ask an adapter for its state, if it can be asked without waiting."""
    if bus is None:
        return None
    if interface == "pcan":
        return lambda: _of_pcan(int(bus.status()))  # type: ignore[attr-defined]
    if interface in _ASKABLE:
        return lambda: _PCAN[0x00010] if bus.state is can.BusState.ERROR else ""
    return None


def _of_pcan(status: int) -> str:
    return next((text for bit, text in _PCAN.items() if status & bit), "")
