"""Tells which compiled functions a run in wall-clock time loads or compiles after it was armed: none should.

A process of its own, in which nothing has run before.
"""

from __future__ import annotations

import gc
import tempfile
from pathlib import Path

from numba.core.dispatcher import Dispatcher

from hil.engine import RunRequest, recorder, run_plan
from tests.benches_for_tests import plan
from tests.hil.engine.test_wall_clock import STEPS, bench_in_real_time

_OTHER_END = ("sim_backend", "hil.plant")
_seen: dict[str, set[str]] = {}
_collections: list[bool] = []


def _signatures() -> set[str]:
    found = [thing for thing in gc.get_objects() if issubclass(type(thing), Dispatcher)]
    return {
        f"{one.py_func.__module__}.{one.py_func.__qualname__}{signature}"
        for one in found
        for signature in one.signatures
        if not one.py_func.__module__.startswith(_OTHER_END)
    }


class Watched(recorder.Recorder):
    """Looks when the drives are enabled, and when they are safe again."""

    def event(self, clock_s: float, kind: str, text: str) -> None:
        if kind in ("arm", "safe_state"):
            _seen[kind] = _signatures()
        super().event(clock_s, kind, text)


def main() -> None:
    import hil.engine.run as run

    run.Recorder = Watched  # type: ignore[misc,attr-defined]
    with bench_in_real_time("armed") as (bench, _, _), tempfile.TemporaryDirectory() as folder:
        run_plan(RunRequest(plan(STEPS), bench, Path(folder)))
    print("\n".join(sorted(_seen["safe_state"] - _seen["arm"])))


if __name__ == "__main__":
    main()
