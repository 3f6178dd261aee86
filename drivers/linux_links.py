"""What Linux knows of a CAN interface: state, error counters and the bit rate that `ip link` has set."""

from __future__ import annotations

import json
import subprocess
from dataclasses import dataclass
from typing import Any

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
