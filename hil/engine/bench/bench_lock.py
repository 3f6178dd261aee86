"""One run at a time on a bench: whoever drives its buses holds a lock on each."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

from hil.core.errors import BenchError
from hil.core.files.locks import HeldError, lock_named
from hil.engine.bench.bench_tables import BenchFile
from hil.engine.bench.bus_settings import identity_of, port_of_any_adapter


@contextlib.contextmanager
def alone_on(file: BenchFile) -> Iterator[None]:
    """Hold the bench's buses, each known by its physical port, whatever the bench file is called.

    Raises:
        BenchError: another process of this machine drives one of them; names the process.
    """
    with contextlib.ExitStack() as held:
        for port, (name, shared) in sorted(_locks_of(file).items()):
            try:
                held.enter_context(lock_named(port, shared=shared))
            except HeldError as error:
                raise BenchError(
                    f"the bench is in use: {error} holds {port}",
                    where=f"bus '{name}'",
                    fix="wait until it has ended, or stop it",
                ) from None
            except OSError as error:
                raise BenchError(
                    f"the bench cannot be locked: {error.strerror}",
                    where=str(error.filename),
                    fix="make the folder writable",
                ) from error
        yield


def _locks_of(file: BenchFile) -> dict[str, tuple[str, bool]]:
    """What is locked, with the bus that it is for, and whether others of its kind may hold it too.

    A table that says which adapter it means shares the port with others that name another adapter, and with
    none that names no adapter: that may mean this one.
    """
    locks: dict[str, tuple[str, bool]] = {}
    for name, bus in file.buses.items():
        port, any_port = identity_of(bus), port_of_any_adapter(bus)
        if port:
            locks[port] = name, False
        if port != any_port:
            locks.setdefault(any_port, (name, True))
    return locks
