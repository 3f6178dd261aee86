"""What an adapter says of its bus while it is used: bus-off, error-passive, full queues."""

from __future__ import annotations

import logging
from collections.abc import Callable

import can

from drivers import linux_errors

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
            self._tell(linux_errors.fault(message))
            self._remark(linux_errors.remark(message))
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
