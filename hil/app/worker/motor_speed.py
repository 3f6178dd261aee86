"""`python -m hil.app.worker.motor_speed BENCH`: how fast a bench's motor turns, by listening alone.

A service asks that was started while an emergency stop was latched: no run of its own has measured the speed.
Nothing is sent, and no adapter is opened that would acknowledge frames.
"""

from __future__ import annotations

import json
import math
import os
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hil.engine.bench.bench_tables import BenchFile

MOTOR_SPEED = (sys.executable, "-m", "hil.app.worker.motor_speed")
#: s of the bench's clock; the RMCU says its speed every millisecond.
_LISTEN_S = 0.5
_SPEED = "motor_speed_rad_s"
#: Opening these changes nothing on the bus: the kernel, a server or another process has it.
_OF_OTHERS = ("socketcan", "socketcand", "hil-udp")


def main() -> None:
    """Print one line of JSON: `speed_rad_s`, or `why` it cannot be heard and whether that is `final`."""
    writing = os.dup(1)
    os.dup2(2, 1)  # what a library prints is no answer
    from hil.app.worker.lean_imports import import_python_can

    import_python_can()
    from hil.core.errors import HilError
    from hil.engine import load_bench

    try:
        file = load_bench(sys.argv[1])
        why = why_never(file)
        found: dict[str, object] = {"why": why, "final": True} if why else heard(file)
    except HilError as error:
        found = {"why": f"{error.where}: {error.what}" if error.where else error.what}
    os.write(writing, json.dumps(found).encode())


def why_never(file: BenchFile) -> str:
    """Why a bench cannot be listened to without a change on its buses; '' if it can."""
    from hil.engine.bench.bus_settings import listens_only

    if file.simulation is not None:
        return "the bench is simulated, and exists during a run only"
    for name, bus in file.buses.items():
        if bus.interface not in _OF_OTHERS and not listens_only(bus):
            return f"the adapter of bus '{name}' ({bus.interface}) would acknowledge frames when it is opened"
    return ""


def heard(file: BenchFile) -> dict[str, object]:
    """The newest speed of a short time.

    Raises:
        BenchError: another process drives the bench, or no bus of it can be opened.
    """
    from hil.engine.bench.bench_lock import alone_on
    from hil.engine.commissioning.monitor import MonitorRequest, monitor

    with alone_on(file):
        view = monitor(MonitorRequest(file, every_s=_LISTEN_S, for_s=_LISTEN_S))
    channel = view.channels.get(_SPEED)
    if channel is None or not math.isfinite(channel.value):
        return {"why": f"the RMCU sent no speed within {_LISTEN_S:g} s"}
    return {"speed_rad_s": channel.value}


if __name__ == "__main__":
    main()
