"""Tells which compiled functions a run in wall-clock time loads once devices watch their host: none should.

A process of its own, in which nothing has run before: `ready_when_armed BENCH`.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from typing import Any

from hil.core.runtime import compiled
from hil.engine import RunRequest, load_bench, run_plan
from hil.engine.bench.bench import Bench
from hil.engine.bench.request_timing import RequestTiming
from tests.benches_for_tests import plan
from tests.hil.engine.run.test_wall_clock import STEPS

_STARTED, _LOADED = Bench.start_heartbeats, compiled._Cache.load_overload
_watched: list[Bench] = []


def _start_heartbeats(self: Bench, timing: RequestTiming | None = None) -> None:
    _watched.append(self)
    _STARTED(self, timing)


def _load_overload(self: Any, sig: Any, target_context: Any) -> Any:
    if _watched and not _watched[0].loop.shielded:  # after the run criteria are judged: no one waits for that
        print(f"{self._source[0]}.{self._function}{sig}")
    return _LOADED(self, sig, target_context)


def main() -> None:
    Bench.start_heartbeats = _start_heartbeats  # type: ignore[method-assign]
    compiled._Cache.load_overload = _load_overload  # type: ignore[method-assign]
    with tempfile.TemporaryDirectory() as folder:
        outcome = run_plan(RunRequest(plan(STEPS), load_bench(sys.argv[1]), Path(folder)))
    assert outcome.error is None, outcome.error
    assert _watched


if __name__ == "__main__":
    main()
