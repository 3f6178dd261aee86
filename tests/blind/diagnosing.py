"""Asks `hil diagnose` about a case's files, as a user would."""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests.blind.casefiles import OpenFiles

#: Seconds after which a diagnosis counts as failed.
PATIENCE_S = 900.0


@dataclass(frozen=True)
class Reply:
    """What came back: `diagnosis` as in diagnosis.json, or `failure` in words.

    Time is the processor's, user and system: with one thread what a quiet machine would take.
    """

    diagnosis: dict[str, Any]
    failure: str
    processor_s: float


Diagnose = Callable[[OpenFiles, Path], Reply]


def by_command_line(files: OpenFiles, out: Path, *, threads: int = 1) -> Reply:
    """Run `hil diagnose` in a process of its own, with `threads` threads."""
    command = [sys.executable, "-c", "from hil.cli import main; main()", "diagnose", "--json"]
    command += ["--model", str(files.model), "--out", str(out), *map(str, files.recordings)]
    for path in files.holdout:
        command += ["--holdout", str(path)]
    few = {name: str(threads) for name in ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")}
    before_s = _children_s()
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, timeout=PATIENCE_S, env=os.environ | few, check=False
        )
    except subprocess.TimeoutExpired:
        return Reply({}, f"no answer within {PATIENCE_S:g} s", PATIENCE_S)
    processor_s = _children_s() - before_s
    if done.returncode != 0:
        last = done.stderr.strip().splitlines()[-1:] or ["no message"]
        return Reply({}, f"exit code {done.returncode}: {last[0]}", processor_s)
    return _read(out, processor_s)


def _children_s() -> float:
    """Processor time of every process that was started from here and has ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _read(out: Path, processor_s: float) -> Reply:
    try:
        return Reply(json.loads((out / "diagnosis.json").read_text(encoding="utf-8")), "", processor_s)
    except (OSError, json.JSONDecodeError) as error:
        return Reply({}, f"no readable diagnosis.json: {error}", processor_s)


def says_nothing(files: OpenFiles, out: Path) -> Reply:
    """A stand-in for the scoring's own tests: it never sees a gap."""
    del files, out
    return Reply({"verdict": "none", "effects": [], "alternatives": []}, "", 0.0)
