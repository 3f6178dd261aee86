"""Opens a CAN bus by python-can: what adapters want otherwise, and what to tell when one is not there."""

from __future__ import annotations

import contextlib
import errno
import logging
import socket
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import can

from hil.core.errors import BenchError
from hil.core.errors.wording import printable

_LOG = logging.getLogger(__name__)

_RECEIVE_BUFFER_BYTES = 8 << 20  # some seconds of a full bus; SocketCAN drops in silence when it is full
_SO_RCVBUFFORCE = 33  # Linux: beyond net.core.rmem_max, for root
_CONNECT_S = 1.0
# What python-can cannot do without, in the words of who has to install it
_SOFTWARE = {
    "canalystii": "the Python package 'canalystii'",
    "cantact": "the Python package 'cantact'",
    "etas": "the ETAS BOA driver, which is for Windows",
    "gs_usb": "the Python package 'gs_usb'; on Linux interface = 'socketcan' does with the kernel's driver",
    "iscan": "Thorsis' isCAN driver",
    "ixxat": "HMS's VCI driver, which is for Windows; on Linux use its SocketCAN driver",
    "kvaser": "Kvaser's CANlib (on Linux: linuxcan)",
    "neousys": "the Neousys WDT_DIO driver",
    "neovi": "Intrepid's driver and the Python package 'python-ics'",
    "nican": "the NI-CAN driver, which is for Windows",
    "nixnet": "the NI-XNET driver and the Python package 'nixnet', which are for Windows",
    "pcan": "PEAK's PCAN-Basic library; on Linux interface = 'socketcan' does with the kernel's driver",
    "systec": "the SYS TEC driver, which is for Windows",
    "udp_multicast": "the Python package 'msgpack'",
    "usb2can": "the USB2CAN driver and the Python package 'pywin32', which are for Windows",
    "vector": "Vector's XL driver library, which is for Windows",
}
_OWN_MESSAGES = "receive_own_messages"
_ECHOING = {"socketcan", "hil-udp"}  # more can, if the bench file's options say so: kvaser, pcan, vector
_NOT_THERE = (ImportError, NameError, AttributeError, NotImplementedError)  # what a missing driver looks like


@dataclass(frozen=True)
class CanSettings:
    """What a bench file says of one bus.

    Attributes:
        name: in the bench file.
        interface: python-can's name of the adapter.
        channel: as its adapter counts or calls it.
        bit_rate: bit/s; in the arbitration phase, where there is another for data.
        fd: whether the controller is opened for CAN FD; frames of more than 8 bytes are left out.
        data_bit_rate: bit/s of CAN FD's data phase.
        timing: bit timing by registers or sample points; None leaves it to the adapter's software.
        options: further arguments for `can.Bus`.
    """

    name: str
    interface: str
    channel: str | int
    bit_rate: int
    fd: bool = False
    data_bit_rate: int | None = None
    timing: can.BitTiming | can.BitTimingFd | None = None
    options: Mapping[str, Any] = field(default_factory=dict)

    @property
    def echoing(self) -> bool:
        """Whether own frames come back, with the time at which they were on the bus."""
        return bool(self.options.get(_OWN_MESSAGES, self.interface in _ECHOING))

    @property
    def where(self) -> str:
        """For messages."""
        return f"bus '{self.name}' ({self.interface} {printable(self.channel, 80)})"


def open_can(settings: CanSettings) -> can.BusABC:
    """Open a bus; what the bench file says counts, and no configuration file of python-can's.

    Raises:
        BenchError: the adapter, its driver or the other end is not there, or does not take the settings.
    """
    try:
        if settings.interface == "socketcand":
            _look_for_server(settings)
            # It warns of every piece of a message whose rest comes later.
            logging.getLogger("can.interfaces.socketcand").setLevel(logging.ERROR)
        bus = _opened(settings)
    except Exception as error:  # an adapter's own software raises what it likes
        raise _not_opened(settings, error) from error
    if settings.interface == "socketcan":
        _enlarge_receive_buffer(settings, bus)
    return bus


def _opened(settings: CanSettings) -> can.BusABC:
    arguments: dict[str, Any] = {"bitrate": settings.bit_rate, **settings.options}
    if settings.echoing:
        arguments[_OWN_MESSAGES] = True
    if settings.fd:
        arguments["fd"] = True
    if settings.data_bit_rate is not None:
        # NI calls it otherwise
        arguments["fd_bitrate" if settings.interface == "nixnet" else "data_bitrate"] = settings.data_bit_rate
    if settings.timing is not None:
        arguments["timing"] = settings.timing
    if settings.interface == "slcan":
        from drivers.slcan import SlcanBus  # here: benches without a serial line start without pyserial

        return SlcanBus(str(settings.channel), **arguments)
    return can.Bus(
        interface=settings.interface,
        channel=settings.channel,  # type: ignore[arg-type]
        ignore_config=True,
        **arguments,
    )


def _look_for_server(settings: CanSettings) -> None:
    """python-can asks for a server that is not there again and again for ten seconds."""
    address = (str(settings.options.get("host", "")), int(settings.options.get("port", 0)))
    socket.create_connection(address, _CONNECT_S).close()


def _enlarge_receive_buffer(settings: CanSettings, bus: can.BusABC) -> None:
    """Ask the kernel for room; it drops what does not fit and says nothing."""
    granted = enlarged(bus.socket, _RECEIVE_BUFFER_BYTES)  # type: ignore[attr-defined]
    _LOG.info("%s: receive buffer of %d bytes granted", settings.where, granted)
    if granted < _RECEIVE_BUFFER_BYTES:
        _LOG.warning(
            "%s: asked for a receive buffer of %d bytes; 'sysctl net.core.rmem_max' bounds it",
            settings.where,
            _RECEIVE_BUFFER_BYTES,
        )


def enlarged(port: socket.socket, wanted_bytes: int) -> int:
    """Raise a socket's receive buffer; the bytes that the kernel granted (Linux counts its records, too)."""
    for option in (_SO_RCVBUFFORCE, socket.SO_RCVBUF):
        with contextlib.suppress(OSError):
            port.setsockopt(socket.SOL_SOCKET, option, wanted_bytes)
        granted = port.getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF)
        if granted >= wanted_bytes:
            break
    return granted


def _not_opened(settings: CanSettings, error: Exception) -> BenchError:
    words = printable(str(error).strip().partition("\n")[0], 200) or type(error).__name__
    software = _SOFTWARE.get(settings.interface)
    library = isinstance(error, OSError) and "library not found" in words
    if software and (isinstance(error, _NOT_THERE) or library):
        what, fix = f"cannot be opened: its driver is not installed ({words})", f"install {software}"
    elif settings.interface == "socketcand" and isinstance(error, OSError):
        address = f"{settings.options.get('host')}:{settings.options.get('port')}"
        what = f"cannot be opened: no socketcand answers at {printable(address, 80)} ({words})"
        fix = "start socketcand there, or correct host and port under options in the bench file"
    elif settings.interface == "socketcan":
        what = f"cannot be opened: {words}"
        if getattr(error, "errno", None) == errno.EAFNOSUPPORT:
            fix = "this system has no SocketCAN: 'modprobe can_raw', or use another interface"
            return BenchError(what, where=settings.where, fix=fix)
        up = f"ip link set {printable(settings.channel, 20)} up type can bitrate {settings.bit_rate}"
        fix = f"'ip link show type can' lists the interfaces there are, '{up}' brings one up"
    else:
        what = f"cannot be opened: {words}"
        fix = "check [buses] in the bench file, the adapter and its driver"
    return BenchError(what, where=settings.where, fix=fix)
