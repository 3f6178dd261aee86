"""A bus's table in the bench file: which bus it means, what opens it, and what an adapter does not take.

A bus's table in the bench file: which bus it means, what opens it, and what an adapter does not take.

Which bus a table of a bench file means: the adapter's own port, whatever else the table says of it.

Two files that name one port are one bench, under any name, on any baud rate and with any option. Lock, latch,
doctor, service and agents all ask here.
"""

from __future__ import annotations

import ipaddress
import os
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import can

from drivers import CanSettings
from hil.core.errors.wording import printable
from hil.engine.bench.bench_tables import BenchFile, Bus, Timing

_IN_PROCESS = ("hil-sim", "virtual")  # no one outside of the process can reach them
#: Options of python-can's that say which of several adapters is meant; all others only say how it is opened.
_WHICH = (
    *("serial", "serial_number", "unique_hardware_id", "device_id", "device", "dev_id"),
    *("hwid", "hw_id", "bus", "address", "index", "dev"),
)
#: udev's names of serial adapters: they stay when an adapter is pulled and comes back as another tty.
_BY_ID = Path("/dev/serial/by-id")
_ALIKE = {"socketcan_native": "socketcan", "socketcan_ctypes": "socketcan"}
_BAUD = re.compile(r"@\d+$")  # slcan's channel may end in the rate of its serial line
_ADDRESS = re.compile(r"(?P<host>[^/\s]+):(?P<port>\d+)")


def identity_of(bus: Bus) -> str:
    """The physical port of a bus, as a word or some; '' where no other process can reach it."""
    port = port_of_any_adapter(bus)
    if not port or port.startswith("port "):
        return port
    which = [f"{key}={bus.options[key]}" for key in sorted(_WHICH) if bus.options.get(key) is not None]
    return " ".join([port, *which])


def port_of_any_adapter(bus: Bus) -> str:
    """The same as if the table did not say which of several adapters it means: that may be any of them."""
    if bus.interface in _IN_PROCESS:
        return ""
    channel = str(bus.channel)
    if bus.interface == "slcan" or channel.startswith("/"):
        channel = _BAUD.sub("", channel)
    if channel.startswith("/"):
        return f"port {_adapter_at(channel)}"  # whichever protocol is spoken there
    if re.fullmatch(r"COM\d+", channel, re.IGNORECASE):
        return f"port {channel.upper()}"
    address = _network_address(bus)
    interface = _ALIKE.get(bus.interface, bus.interface)
    return " ".join([interface, *([address] if address else []), _plain(channel)])


def identities_of(file: BenchFile) -> dict[str, str]:
    """The identities of a bench's buses, each with the name of its table; those within a process left out."""
    return {identity: name for name, bus in file.buses.items() if (identity := identity_of(bus))}


def within_process(file: BenchFile) -> bool:
    """Whether the whole bench is one that no other process can reach."""
    return not identities_of(file)


def may_be_same(one: str, other: str) -> bool:
    """Whether two identities may mean one port: a table that does not say which adapter may mean any."""
    return one == other or one.startswith(f"{other} ") or other.startswith(f"{one} ")


def share_a_bus(some: Iterable[str], others: Iterable[str]) -> bool:
    """Whether one of `some` may be one of `others`."""
    others = list(others)
    return any(may_be_same(one, other) for one in some for other in others)


def _adapter_at(path: str) -> str:
    """The adapter that a device file leads to: by udev's name if it has one, else the device."""
    real = os.path.realpath(path)
    try:
        links = sorted(link for link in _BY_ID.iterdir() if os.path.realpath(link) == real)
    except OSError:
        links = []
    return str(links[0]) if links else real


def _network_address(bus: Bus) -> str:
    """Host and port of an adapter in the network that its options name."""
    if "host" not in bus.options and "ip" not in bus.options:
        port = bus.options.get("port")
        return f"port={port}" if port is not None else ""
    host = _plain_host(str(bus.options.get("host", bus.options.get("ip"))))
    return f"{host}:{bus.options['port']}" if "port" in bus.options else host


def _plain(channel: str) -> str:
    """A channel that is an address in its one form: localhost and 127.0.0.1 are one."""
    match = _ADDRESS.fullmatch(channel)
    return f"{_plain_host(match['host'])}:{int(match['port'])}" if match else channel


def _plain_host(host: str) -> str:
    """A host without asking the network for it."""
    host = host.strip("[]").lower().rstrip(".")
    if host in ("localhost", "localhost.localdomain", "ip6-localhost"):
        return "127.0.0.1"
    try:
        address = ipaddress.ip_address(host)
    except ValueError:
        return host
    return "127.0.0.1" if address.is_loopback else str(address)


# python-can's own interfaces by what their classes take; others swallow it in silence.
_TIMED = {"canalystii", "cantact", "kvaser", "nixnet", "pcan", "slcan", "usb2can", "vector"}
_FD = {"etas", "ixxat", "kvaser", "nixnet", "pcan", "slcan", "socketcan", "vector"}
_DATA_RATE = _FD - {"socketcan"}
_FD_BY_TIMING = {"pcan", "slcan"}  # the rate of the data phase reaches them in `timing` only
_COUNTED = {"cantact", "ixxat", "kvaser"}
_NAMED = {"robotell", "seeedstudio", "serial", "slcan", "socketcan", "socketcand"}
_NO_HARDWARE = ("vcan", "simcan")  # interfaces so named reach no hardware, and may go slower than real time
_OWN = {name for name, (module, _) in can.interfaces.BACKENDS.items() if module.startswith("can.")}
_LINUX_SETS_IT = (
    "Linux sets it: ip link set {channel} type can bitrate ... sample-point ... dbitrate ... fd on"
)


#: How an interface is set to listen only: not even to acknowledge. SocketCAN's is set by `ip link`.
_LISTENING: dict[str, dict[str, Any]] = {
    "kvaser": {"driver_mode": False},
    "nixnet": {"listen_only": True},
    "pcan": {"state": can.BusState.PASSIVE},
    "seeedstudio": {"operation_mode": "silent"},
    "slcan": {"listen_only": True},
    "systec": {"state": can.BusState.PASSIVE},
    "vector": {"listen_only": True},
}


def listens_only(bus: Bus) -> bool:
    """Whether the adapter can be set to listen only."""
    return bus.interface in _LISTENING


def can_settings(name: str, bus: Bus, *, listen_only: bool = False) -> CanSettings:
    """What opens the bus.

    Args:
        listen_only: that the adapter acknowledges nothing, if it can be reported so.

    Raises:
        ValueError: no such bit timing can be made.
    """
    return CanSettings(
        name=name,
        interface=bus.interface,
        channel=bus.channel,
        bit_rate=bus.bit_rate,
        fd=bus.fd,
        data_bit_rate=bus.data_bit_rate,
        timing=_timing(bus, bus.timing) if bus.timing else None,
        options={**bus.options, **(_LISTENING.get(bus.interface, {}) if listen_only else {})},
    )


def slows_down(bus: Bus) -> bool:
    """Whether what is at the other end can be a simulated bench that does not keep real time."""
    if bus.interface == "slcan":
        return str(bus.channel).startswith("/dev/pts/")
    if bus.interface == "socketcand":
        return bus.options.get("host") in ("127.0.0.1", "localhost")
    if bus.interface == "socketcan":
        return str(bus.channel).startswith(_NO_HARDWARE)
    return bus.interface == "hil-udp"


def adapter_mistakes(name: str, bus: Bus) -> Iterator[str]:
    """What the adapter does not take: key, value and what to do, each a line."""
    yield from _of_channel(f"buses.{name}.channel", bus)
    own = bus.interface in _OWN
    key = f"buses.{name}"
    linux = _LINUX_SETS_IT.format(channel=printable(bus.channel, 20))
    hint = linux if bus.interface == "socketcan" else "leave it out"
    if bus.timing and own and bus.interface not in _TIMED:
        yield f"{key}.timing: '{bus.interface}' takes no bit timing; {hint}"
    if bus.fd and own and bus.interface not in _FD:
        yield f"{key}.fd: '{bus.interface}' does no CAN FD; leave it out"
    if bus.data_bit_rate is not None and not bus.fd:
        yield f"{key}.data_bit_rate = {bus.data_bit_rate}: without CAN FD; add fd = true, or leave it out"
    elif bus.data_bit_rate is not None and own and bus.interface not in _DATA_RATE:
        yield f"{key}.data_bit_rate = {bus.data_bit_rate}: '{bus.interface}' takes none; {hint}"
    if bus.fd and bus.interface in _FD_BY_TIMING and bus.timing is None:
        yield f"{key}.fd: '{bus.interface}' needs the timing of both phases; add {key}.timing"
    if bus.timing:
        yield from _of_timing(f"{key}.timing", bus, bus.timing)
    if bus.interface == "socketcand":
        for option in ("host", "port"):
            if option not in bus.options:
                where = 'options = { host = "127.0.0.1", port = 29536 }'
                yield f"{key}.options.{option}: is missing; give the address of socketcand: {where}"


def _of_channel(key: str, bus: Bus) -> Iterator[str]:
    interface, channel = bus.interface, bus.channel
    if interface in _COUNTED and isinstance(channel, str):
        number = channel if channel.isdecimal() else "0"
        yield f"{key} = '{printable(channel)}': '{interface}' counts its channels; write channel = {number}"
    elif interface in _NAMED and isinstance(channel, int):
        name = "can0" if interface.startswith("socketcan") else "/dev/ttyACM0"
        yield f"{key} = {channel}: '{interface}' knows channels by name; write channel = \"{name}\""


def _of_timing(key: str, bus: Bus, timing: Timing) -> Iterator[str]:
    if timing.has_data_phase != bus.fd:
        wanted = (
            "give data_sample_point, or data_tseg1, data_tseg2 and data_sjw" if bus.fd else "add fd = true"
        )
        yield f"{key}: {'is without' if bus.fd else 'has'} a data phase; {wanted}"
    elif bus.fd and bus.data_bit_rate is None:
        yield f"{key}: the data phase has no rate; add data_bit_rate"
    else:
        try:
            _timing(bus, timing)
        except ValueError as error:
            yield f"{key}: {printable(error, 200)}"


def _timing(bus: Bus, timing: Timing) -> can.BitTiming | can.BitTimingFd:
    if not bus.fd:
        if timing.sample_point is not None:
            return can.BitTiming.from_sample_point(timing.f_clock, bus.bit_rate, timing.sample_point)
        return can.BitTiming.from_bitrate_and_segments(
            timing.f_clock, bus.bit_rate, timing.tseg1 or 0, timing.tseg2 or 0, timing.sjw or 0
        )
    rate = bus.data_bit_rate or 0
    if timing.sample_point is not None:
        return can.BitTimingFd.from_sample_point(
            timing.f_clock, bus.bit_rate, timing.sample_point, rate, timing.data_sample_point or 0.0
        )
    nominal = (timing.tseg1 or 0, timing.tseg2 or 0, timing.sjw or 0)
    data = (timing.data_tseg1 or 0, timing.data_tseg2 or 0, timing.data_sjw or 0)
    return can.BitTimingFd.from_bitrate_and_segments(timing.f_clock, bus.bit_rate, *nominal, rate, *data)
