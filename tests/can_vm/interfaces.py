"""The machine's CAN controllers: simcan0 and simcan1 on one bus, simcan2 and simcan3 on the other."""

from __future__ import annotations

import subprocess
import time
from pathlib import Path

_NETWORK = Path("/sys/class/net")
_RESCAN = Path("/sys/bus/pci/rescan")
_COMES_BACK_WITHIN_S = 30.0


def ip(*arguments: str) -> None:
    """`ip link set ...`."""
    subprocess.run(["ip", "link", "set", *arguments], check=True)


def up(name: str, bit_rate: int = 1_000_000) -> None:
    """Take a controller up; a vcan has no bit rate."""
    kind = [] if name.startswith("vcan") else ["txqueuelen", "500", "type", "can", "bitrate", str(bit_rate)]
    ip(name, "up", *kind)


def unplugged(name: str) -> None:
    """Take a controller off the PCI bus, as pulling an adapter's plug does."""
    (_NETWORK.joinpath(name, "device").resolve() / "remove").write_text("1")


def plugged_in(name: str, bit_rate: int = 1_000_000) -> None:
    """Find a controller that was unplugged again; Linux gives it a new name, here it gets its old one."""
    before = {path.name for path in _NETWORK.iterdir()}
    _RESCAN.write_text("1")
    end_s = time.monotonic() + _COMES_BACK_WITHIN_S
    while not (new := {path.name for path in _NETWORK.iterdir()} - before) and time.monotonic() < end_s:
        time.sleep(0.1)
    (back,) = new
    if back != name:
        ip(back, "name", name)
    up(name, bit_rate)
