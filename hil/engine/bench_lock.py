"""One run at a time on a bench: whoever drives its buses holds a lock on each."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

from hil.core.errors import BenchError
from hil.core.locks import HeldError, lock_named
from hil.engine.bench_tables import BenchFile
from hil.engine.bus_identity import identities_of


@contextlib.contextmanager
def alone_on(file: BenchFile) -> Iterator[None]:
    """Hold the bench's buses, each known by its physical port, whatever the bench file is called.

    Raises:
        BenchError: another process of this machine drives one of them; names the process.
    """
    buses = identities_of(file)
    with contextlib.ExitStack() as held:
        for identity in sorted(buses):
            try:
                held.enter_context(lock_named(identity))
            except HeldError as error:
                raise BenchError(
                    f"the bench is in use: {error} holds {identity}",
                    where=f"bus '{buses[identity]}'",
                    fix="wait until it has ended, or stop it",
                ) from None
            except OSError as error:
                raise BenchError(
                    f"the bench cannot be locked: {error.strerror}",
                    where=str(error.filename),
                    fix="make the folder writable",
                ) from error
        yield
