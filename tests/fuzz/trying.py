"""Tries damaged inputs of one parser, with a watch for hanging and a limit of memory."""

from __future__ import annotations

import contextlib
import os
import random
import resource
import signal
import time
import traceback
from collections.abc import Iterator
from pathlib import Path
from types import FrameType

from hil.core.errors import HilError
from tests.fuzz.damaging import damaged
from tests.fuzz.targets import TARGETS

HANGS_S = 20
_ROOM = 2 << 30  # bytes beyond what the process has already


class HungError(Exception):
    """It took too long."""


@contextlib.contextmanager
def watched() -> Iterator[None]:
    """Time and memory are bounded inside."""

    def ring(number: int, frame: FrameType | None) -> None:
        raise HungError

    before = signal.signal(signal.SIGALRM, ring)
    limits = resource.getrlimit(resource.RLIMIT_AS)
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    resource.setrlimit(resource.RLIMIT_AS, (pages * os.sysconf("SC_PAGE_SIZE") + _ROOM, limits[1]))
    signal.alarm(HANGS_S)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)
        resource.setrlimit(resource.RLIMIT_AS, limits)


def try_many(
    name: str, seed: int, folder: Path, *, most: int | None = None, until_s: float = 0.0
) -> list[str]:
    """What was found; `most` inputs, or as many as there is time for (`time.monotonic`)."""
    target, chance = TARGETS[name], random.Random(f"{name} {seed}")
    seeds, found, tried = target.seeds(), [], 0
    path = folder / f"{name}{target.suffix}"
    while tried < most if most is not None else time.monotonic() < until_s:
        tried += 1
        data = damaged(chance.choice(seeds), chance)
        path.write_bytes(data)
        try:
            with watched():
                target.parse(path)
        except HilError as error:
            if not error.what or len(str(error)) > 5000:
                found.append(f"{name}: a message of {len(str(error))} characters")
        except Exception as error:
            kept = folder / f"{name}-{len(found)}{target.suffix}.found"
            kept.write_bytes(data)
            at = traceback.extract_tb(error.__traceback__)[-1]
            found.append(
                f"{name}: {type(error).__name__}: {str(error)[:200]} ({at.filename}:{at.lineno}); {kept}"
            )
    return found
