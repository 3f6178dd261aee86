"""Keeps stops on the disk, in a thread of its own: no disk that hangs holds up the next stop."""

from __future__ import annotations

import logging
import queue
import threading
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from hil.core.errors import HilError
from hil.execution.benches import Bench
from hil.service.stop_post._answering import Asked
from hil.service.stop_post._messages import OwnBench

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Latched:
    """What became of a latch: `new` if there was none before, `problem` if it cannot be written."""

    bench: str
    asked: Asked
    new: bool = False
    problem: str = ""


class Latches:
    """Latches benches one after the other.

    Args:
        done: called from the thread once it is on the disk or cannot be.
    """

    def __init__(self, done: Callable[[Latched], None]) -> None:
        self._done = done
        self._known: dict[str, OwnBench] = {}
        self._benches: dict[str, Bench] = {}
        self._waiting: queue.SimpleQueue[tuple[str, Asked, Path]] = queue.SimpleQueue()
        threading.Thread(target=self._work, daemon=True, name="latches").start()

    def know(self, benches: dict[str, OwnBench]) -> None:
        """The service's own benches, by name: read beforehand, for later may be too late."""
        changed = [name for name in self._known if benches.get(name) != self._known[name]]
        self._known = benches
        for name in changed:
            self._benches.pop(name, None)
        for name, bench in benches.items():
            if name not in self._benches:
                try:
                    self._benches[name] = _bench_of(bench)
                except HilError as error:
                    logger.error("%s: cannot be latched: %s", name, error)

    def latch(self, bench: str, asked: Asked, folder: Path) -> None:
        """Have it done soon."""
        self._waiting.put((bench, asked, folder))

    def _work(self) -> None:
        while True:
            name, asked, folder = self._waiting.get()
            try:
                bench = self._benches.get(name) or _bench_of(self._known[name])
                new = not bench.stopped()
                if new:  # one latch says it; more would only fill the disk
                    bench.stop(asked.by, folder, origin=asked.origin, way=asked.way)
                self._done(Latched(name, asked, new))
            except (HilError, OSError) as error:
                self._done(Latched(name, asked, problem=str(error)))
            except Exception as error:
                logger.exception("internal error")
                problem = f"internal error: {type(error).__name__}: {error}"
                self._done(Latched(name, asked, problem=problem))


def _bench_of(bench: OwnBench) -> Bench:
    return Bench(bench.file, Path(bench.stops) if bench.stops else None)
