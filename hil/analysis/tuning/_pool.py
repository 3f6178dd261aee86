"""Trials on every core: processes that each hold the trial, and give what candidates came to in order."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Generator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from types import TracebackType

from hil.analysis.tuning._trial import Trial, Tried
from hil.core.channels import ENDING_SIGNALS
from hil.core.runtime.other_process import end_with_parent

Work = tuple[Mapping[str, float], int]
_trial: Trial | None = None  # of this process, where it is one of a pool's


class Pool:
    """Tries candidates; use it as a context.

    Args:
        trial: what they are tried with.
        processes: how many at once; 1: in this very process; None: one for each core that may be used.
    """

    def __init__(self, trial: Trial, processes: int | None = None) -> None:
        self.trial = trial
        self.processes = len(os.sched_getaffinity(0)) if processes is None else processes
        self._executor: ProcessPoolExecutor | None = None
        self.runs = 0

    def __enter__(self) -> Pool:
        if self.processes > 1:
            os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # each has one core
            self._executor = ProcessPoolExecutor(
                self.processes,
                mp_context=multiprocessing.get_context("spawn"),
                initializer=_begin,
                initargs=(self.trial, os.getpid()),
            )
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._executor is not None:
            self._executor.shutdown(wait=True, cancel_futures=True)

    def tried(self, work: Sequence[Work], ask: Callable[[], None] = lambda: None) -> list[Tried]:
        """Each candidate on its car, in order; `ask` is called before each, and may raise to end it soon."""
        ask()
        found: list[Tried] = []
        with contextlib.closing(self._results(work)) as results:
            for one in results:  # those that are not started are taken back where `ask` raises
                self.runs += 1
                found.append(one)
                if len(found) < len(work):
                    ask()
        return found

    def _results(self, work: Sequence[Work]) -> Generator[Tried]:
        if self._executor is None:
            yield from (self.trial.tried(values, number) for values, number in work)
        else:
            yield from self._executor.map(_tried, work)


def _begin(trial: Trial, parent: int) -> None:
    global _trial
    _trial = trial
    for number in ENDING_SIGNALS:
        signal.signal(number, signal.SIG_IGN)  # the process that asked ends this one
    threading.Thread(target=end_with_parent, args=(parent,), daemon=True).start()


def _tried(work: Work) -> Tried:
    assert _trial is not None
    return _trial.tried(*work)
