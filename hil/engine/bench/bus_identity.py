"""Which bus a table of a bench file means: the adapter's own port, whatever else the table says of it.

Two files that name one port are one bench, under any name, on any baud rate and with any option. Lock, latch,
doctor, service and agents all ask here.
"""

from __future__ import annotations

import ipaddress
import os
import re
from collections.abc import Iterable
from pathlib import Path

from hil.engine.bench.bench_tables import BenchFile, Bus

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
