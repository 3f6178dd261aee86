"""The recording of a run whose process was lost, and a result made from it."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import TypeAlias

from hil.core.errors import HilError
from hil.core.recording import Recording, read_recording, run_of
from hil.core.result import CriterionResult, RunResult, SafeState, verdict_of
from hil.engine.ipc.ipc import RunRequest
from test_plans import judge

Identity: TypeAlias = tuple[int, int]

logger = logging.getLogger(__name__)


def identity_of(path: Path) -> Identity | None:
    """What tells a file from an earlier one of its name; None if there is none."""
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_ino, found.st_ctime_ns


def recording_left(path: Path, before: Identity | None) -> Recording | None:
    """What was recorded; None if nothing was, or if the file is still the one that was there before."""
    if identity_of(path) in (None, before):
        return None
    try:
        return read_recording(path, least_samples=0, allow_missing=True)
    except HilError as error:
        logger.warning("the recording cannot be read: %s", error)
        return None


def result_left(recording: Recording, request: RunRequest, safe: SafeState, error: HilError) -> RunResult:
    """The result of a run that was cut off: whole segments are judged."""
    plan, bench = request.plan, request.bench
    result = RunResult(
        verdict="error", plan=plan.name, bench=bench.name, real_time_factor=0.0, bench_time_s=0.0,
        safe_state=safe,
    )  # fmt: skip
    criteria: tuple[CriterionResult, ...] = ()
    try:
        result = run_of(recording) or result
        criteria = judge(plan, recording, result.segments)
    except Exception:  # what became of the bench is reported all the same
        logger.exception("the recording cannot be evaluated")
    changes = {
        "plan": plan.name,
        "bench": bench.name,
        "criteria": criteria,
        "verdict": verdict_of(criteria, stopped=True),
        "safe_state": safe,
        "reason": str(error),
    }
    return result.model_copy(update=changes)
