"""Batches on dask.distributed: processes of this machine, or a scheduler's workers on many.

The only module that imports it: `pip install 'eaxle-hil[campaign]'`.
"""

from __future__ import annotations

import contextlib
import logging
import multiprocessing.resource_tracker
import queue
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from hil.campaign._batches import Batch, Done
from hil.campaign._setting import load_setting
from hil.campaign._simulations import Row, Simulations
from hil.core.errors import BadInputError, BenchError, HilError
from hil.engine.stopping import held_back

try:
    import dask
    import distributed
except ImportError as missing:
    raise BadInputError(
        "the package 'distributed' is not installed",
        fix="pip install 'eaxle-hil[campaign]', or --workers 0 for this process alone",
    ) from missing

_WAIT_S = 0.2
_CONNECT_S = 10
_AHEAD = 3  # batches for each worker that are handed out: none waits for the next
_LOGGERS = ("distributed", "distributed.client", "tornado", "tornado.application")
#: Memory that a simulation gives back is asked for again by the next one: it stays with the process. And nobody
#: looks at a profile of the workers.
_SETTINGS = {
    "distributed.nanny.pre-spawn-environ": {"OPENBLAS_NUM_THREADS": 1},
    "distributed.worker.profile.enabled": False,
}
_known: dict[str, Simulations] = {}  # of this process, where it is a worker


class Workers:
    """Carries batches out elsewhere; use it as a context.

    Args:
        source: the campaign's file; every worker reads it, and must see the same.
        digest: of the campaign as it is here.
        processes: of this machine.
        scheduler: address of one whose workers are used in place of those.

    Raises:
        BenchError: nobody answers there.
    """

    def __init__(self, source: Path, digest: str, processes: int, scheduler: str = "") -> None:
        self._source, self._digest = str(source.resolve()), digest
        self._processes, self._scheduler = processes, scheduler
        self._ended: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._held = contextlib.ExitStack()
        self._client: Any = None
        self._out: dict[str, tuple[Any, Batch]] = {}

    def __enter__(self) -> Workers:
        for name in _LOGGERS:  # what they say is told in our words
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
        """Processes of this machine: nobody else reaches them, and Ctrl-C is for this process to answer."""
        multiprocessing.resource_tracker.ensure_running()
        with held_back(), dask.config.set(_SETTINGS):
            cluster = self._held.enter_context(
                distributed.LocalCluster(
                    n_workers=self._processes,
                    threads_per_worker=1,
                    host="127.0.0.1",
                    dashboard_address=None,
                    memory_limit=0,
                    security=distributed.Security.temporary(),
                    silence_logs=logging.CRITICAL,
                )
            )
            return distributed.Client(cluster, set_as_default=False)

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
        """Workers that are there now.

        Raises:
            BenchError: the scheduler is gone.
        """
        if not self._scheduler:
            return self._processes
        try:
            return len(self._client.scheduler_info(n_workers=-1)["workers"])
        except (OSError, RuntimeError) as error:
            raise self._gone() from error

    @property
    def under_way(self) -> int:
        """Batches that are handed out."""
        return len(self._out)

    @property
    def wanted(self) -> int:
        """How many more batches keep every worker busy."""
        return max(0, _AHEAD * max(1, self.count) - self.under_way)

    def submit(self, batch: Batch) -> None:
        """Hand a batch out."""
        future = self._client.submit(_rows, self._source, self._digest, batch.first, batch.last, pure=False)
        self._out[future.key] = future, batch
        future.add_done_callback(self._ended.put)

    def keep_running_only(self) -> None:
        """Take back what no worker has begun: they take the oldest first."""
        for key in list(self._out)[max(1, self.count) :]:
            self._out.pop(key)[0].cancel()

    def done(self) -> Iterator[Done]:
        """What has ended since, waiting a moment for it; without rows, a simulation that kills its worker.

        Raises:
            BenchError: the scheduler is gone, or a worker cannot do it.
        """
        with contextlib.suppress(queue.Empty):
            ended = self._ended.get(timeout=_WAIT_S)
            while True:
                if ended.key in self._out:
                    yield from self._taken(*self._out.pop(ended.key))
                ended = self._ended.get_nowait()
        if self._client.status != "running":
            raise self._gone()

    def _taken(self, future: Any, batch: Batch) -> Iterator[Done]:
        """Rows of a batch; one that kills its workers is halved until it is known which simulation does."""
        if future.status == "finished":
            yield batch, future.result()
            return
        if future.status in ("cancelled", "lost"):
            raise self._gone()
        error = future.exception()
        if not isinstance(error, distributed.KilledWorker):
            raise error if isinstance(error, HilError) else _failed(error)
        if len(batch) == 1:
            yield batch, None
        else:
            middle = (batch.first + batch.last) // 2
            self.submit(Batch(batch.first, middle))
            self.submit(Batch(middle + 1, batch.last))

    def _gone(self) -> BenchError:
        where = f"--scheduler {self._scheduler}" if self._scheduler else ""
        return BenchError(
            "the scheduler is gone", where=where, fix="what was done is kept: go on with --resume"
        )


def _failed(error: object) -> BenchError:
    return BenchError(
        f"a worker failed: {type(error).__name__}: {error}"[:500],
        fix="workers need the same eaxle-hil, and the same files under the same paths, as this command",
    )


def _rows(source: str, digest: str, first: int, last: int) -> list[Row]:
    """In a worker."""
    if digest not in _known:
        setting = load_setting(source)
        if setting.digest != digest:
            raise BadInputError(
                "a worker has other files, or another version of this software",
                where=source,
                fix="go on with --resume once all of them have the same",
            )
        _known.clear()
        _known[digest] = Simulations(setting)
    return [_known[digest].row(number) for number in range(first, last + 1)]
