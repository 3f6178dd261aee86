"""One run at a time on a bench: whoever drives its buses holds a lock on each."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator

from hil.core.errors import BenchError
from hil.core.locks import HeldError, lock_named
from hil.engine.bench_tables import BenchFile, Bus

_IN_PROCESS = ("hil-sim", "virtual")  # nobody else can reach them


@contextlib.contextmanager
def alone_on(file: BenchFile) -> Iterator[None]:
    """Hold the bench's buses, each known by its interface and channel, whatever the bench file is called.

    Raises:
        BenchError: another process of this machine drives one of them; names the process.
    """
    buses = {identity: name for name, bus in file.buses.items() if (identity := _identity(bus))}
    with contextlib.ExitStack() as held:
        for identity in sorted(buses):
            try:
                held.enter_context(lock_named(identity))
            except HeldError as error:
                raise BenchError(
                    f"the bench is in use: {error} drives {identity}",
                    where=f"bus '{buses[identity]}'",
                    fix="wait until it has ended, or stop it",
                ) from None
            except OSError as error:
                raise BenchError(
                    f"the bench cannot be locked against others: {error.strerror}",
                    where=str(error.filename),
                    fix="make the folder writable",
                ) from error
        yield


def _identity(bus: Bus) -> str:
    """What two bench files have in common that name the same bus; '' where no other process can reach it."""
    if bus.interface in _IN_PROCESS:
        return ""
    channel = str(bus.channel)
    if channel.startswith("/"):
        channel = os.path.realpath(channel)  # by-id and ttyACM0 are one adapter
    place = [
        str(bus.options[key])
        for key in ("host", "port", "serial", "unique_hardware_id")
        if key in bus.options
    ]
    return " ".join([bus.interface, channel, *place])
