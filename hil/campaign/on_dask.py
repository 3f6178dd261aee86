"""Batches on dask.distributed: processes of this machine, or a scheduler's workers on many.

The only module that imports it: `pip install 'eaxle-hil[campaign]'`.
"""

from __future__ import annotations

import contextlib
import functools
import logging
import math
import multiprocessing.resource_tracker
import queue
import time
from collections import deque
from collections.abc import Iterator
from typing import Any

from hil.campaign._execute import Batch, Done, MakeRows, Row
from hil.campaign._setting import Setting, load_setting
from hil.campaign._simulations import Simulations
from hil.core.errors import BadInputError, BenchError, HilError
from hil.core.errors.extras import not_installed
from hil.engine.stop.stopping import held_back

try:
    import dask
    import distributed
except ModuleNotFoundError as missing:
    raise not_installed(missing, "--workers 0 for this process alone") or missing from missing

_WAIT_S = 0.2
_CONNECT_S = 10
_LOOK_S = 2.0
_COUNT_S = 0.5
_AHEAD = 3  # batches for each worker that are handed out: none waits for the next
_LOGGERS = ("distributed", "distributed.client", "tornado", "tornado.application")
#: Memory that a simulation gives back, the next one asks for again: it stays with the process. And no one
#: looks at a profile of the workers.
_SETTINGS = {
    "distributed.nanny.pre-spawn-environ": {"OPENBLAS_NUM_THREADS": 1},
    "distributed.worker.profile.enabled": False,
    "distributed.deploy.lost-worker-timeout": "1s",
    "distributed.scheduler.allowed-failures": 0,  # what was there when a worker died is looked into at once
}
_known: dict[str, Simulations] = {}  # of this process, where it is a worker


class Workers:
    """Carries batches out elsewhere; use it as a context.

    Args:
        make: makes rows in a worker; what it is made of must be importable there.
        processes: of this machine.
        scheduler: address of one whose workers are used in place of those.

    Raises:
        BenchError: no one answers there.
    """

    def __init__(self, make: MakeRows, processes: int, scheduler: str = "") -> None:
        self._make = make
        self._processes, self._scheduler = processes, scheduler
        self._ended: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._held = contextlib.ExitStack()
        self._client: Any = None
        self._cluster: Any = None
        self._looked_s = self._counted_s = -math.inf
        self._count = 0
        self._out: dict[str, tuple[Any, Batch]] = {}
        self._suspects: deque[Batch] = deque()
        self._deadly: set[Batch] = set()
        self._alone = ""  # key of a suspect that is executed with nothing beside it

    def __enter__(self) -> Workers:
        for name in _LOGGERS:  # what they say is reported in our words
            logging.getLogger(name).setLevel(logging.CRITICAL)
        try:
            self._client = self._held.enter_context(self._remote() if self._scheduler else self._local())
        except BaseException:
            self._held.close()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        for future, _batch in self._out.values():
            with contextlib.suppress(Exception):
                future.cancel()
        self._held.close()

    def _local(self) -> Any:
        """Processes of this machine: no one else reaches them, and Ctrl-C is for this process to answer."""
        multiprocessing.resource_tracker.ensure_running()
        dask.config.set(_SETTINGS)
        with held_back():
            self._cluster = self._held.enter_context(
                distributed.LocalCluster(
                    n_workers=self._processes,
                    threads_per_worker=1,
                    host="127.0.0.1",
                    dashboard_address=None,
                    scheduler_kwargs={"dashboard_address": "127.0.0.1:0"},  # any port: several may run
                    memory_limit=0,
                    security=distributed.Security.temporary(),
                    silence_logs=logging.CRITICAL,
                )
            )
            return distributed.Client(self._cluster, set_as_default=False)

    def _remote(self) -> Any:
        try:
            return distributed.Client(self._scheduler, timeout=_CONNECT_S, set_as_default=False)
        except (OSError, ValueError, TimeoutError) as error:
            raise BenchError(
                f"no scheduler answers: {error}",
                where=f"--scheduler {self._scheduler}",
                fix="begin one with 'dask scheduler', and workers with 'dask worker ADDRESS'",
            ) from error

    @property
    def count(self) -> int:
        """Workers that are there, or were a moment ago: asking the scheduler takes milliseconds.

        Raises:
            BenchError: the scheduler is gone.
        """
        if time.monotonic() - self._counted_s > _COUNT_S:
            try:
                self._count = len(self._client.scheduler_info(n_workers=-1)["workers"])
            except (OSError, RuntimeError) as error:
                raise self._gone() from error
            self._counted_s = time.monotonic()
        return self._count

    def _replace_lost(self) -> None:
        """Begin processes in place of those that died while they began: their keepers have given up."""
        if self._cluster is not None and time.monotonic() - self._looked_s > _LOOK_S:
            self._looked_s = time.monotonic()
            self._cluster.scale(self._processes)

    @property
    def under_way(self) -> int:
        """Batches that are handed out, or held back."""
        return len(self._out) + len(self._suspects)

    @property
    def wanted(self) -> int:
        """How many more batches keep every worker busy."""
        least = 1 if self._scheduler else self._processes
        return max(0, _AHEAD * max(least, self.count) - len(self._out))

    def submit(self, batch: Batch) -> None:
        """Hand a batch out."""
        self._handed_out(batch)

    def _handed_out(self, batch: Batch) -> str:
        future = self._client.submit(self._make, batch.first, batch.last, pure=False)
        self._out[future.key] = future, batch
        future.add_done_callback(self._ended.put)
        return str(future.key)

    def keep_running_only(self) -> None:
        """Take back what no worker has started: they take the oldest first."""
        self._suspects.clear()
        for key in list(self._out)[self.count :]:
            self._out.pop(key)[0].cancel()

    def done(self) -> Iterator[Done]:
        """What has ended since, waiting a moment for it; without rows, a simulation that kills its worker.

        Raises:
            BenchError: the scheduler is gone, or a worker cannot do it.
        """
        self._replace_lost()
        if self._suspects and not self._out:
            self._alone = self._handed_out(self._suspects.popleft())
        with contextlib.suppress(queue.Empty):
            ended = self._ended.get(timeout=_WAIT_S)
            while True:
                if ended.key in self._out:
                    yield from self._taken(*self._out.pop(ended.key))
                ended = self._ended.get_nowait()
        if self._client.status != "running":
            raise self._gone()

    def _taken(self, future: Any, batch: Batch) -> Iterator[Done]:
        """Rows of a batch; one that was there when workers died is a suspect.

        So is whatever waited beside it: suspects are executed at the end, alone, and those that kill their
        workers again are halved until it is known which simulation does.
        """
        if future.status == "finished":
            yield batch, future.result()
            return
        if future.status in ("cancelled", "lost"):
            raise self._gone()
        error = future.exception()
        if not isinstance(error, distributed.KilledWorker):
            raise error if isinstance(error, HilError) else _failed(error)
        if future.key != self._alone:
            self._suspects.append(batch)
        elif len(batch) == 1 and batch in self._deadly:
            yield batch, None
        elif len(batch) == 1:
            self._deadly.add(batch)  # twice is no accident
            self._suspects.append(batch)
        else:
            middle = (batch.first + batch.last) // 2
            self._suspects += (Batch(batch.first, middle), Batch(middle + 1, batch.last))

    def _gone(self) -> BenchError:
        where = f"--scheduler {self._scheduler}" if self._scheduler else ""
        return BenchError(
            "the connection to the scheduler is lost",
            where=where,
            fix="finished simulations are kept; continue with --resume",
        )


def _failed(error: object) -> BenchError:
    return BenchError(
        f"a worker failed: {type(error).__name__}: {error}"[:500],
        fix="workers need the same eaxle-hil, and the same files under the same paths, as this command",
    )


def rows_of(setting: Setting) -> MakeRows:
    """What makes a campaign's rows in a worker, which reads its files and must see the same."""
    return functools.partial(_rows, str(setting.file.source.resolve()), setting.digest)


def _rows(source: str, digest: str, first: int, last: int) -> list[Row]:
    """In a worker."""
    if digest not in _known:
        setting = load_setting(source)
        if setting.digest != digest:
            raise BadInputError(
                "a worker has other files, or another version of this software",
                where=source,
                fix="install the same version and files everywhere, then continue with --resume",
            )
        _known.clear()
        _known[digest] = Simulations(setting)
    return _known[digest].rows(first, last)
