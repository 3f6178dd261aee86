"""Processor time of whole commands as a shell would start them, caches warm, and of a run's parts."""

from __future__ import annotations

import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

_HIL = str(Path(sys.executable).parent / "hil")
_TIMES = 5
_ASKED_S = {"hil run --help": 0.5, "hil check acceptance": 2.0, "hil run acceptance": 6.0}


def main() -> None:
    print(f"{'processor time of a process, s':34}{'least':>8}{'median':>8}{'asked':>8}")
    with tempfile.TemporaryDirectory() as directory:
        out = ["--out", str(Path(directory) / "out"), "--overwrite"]
        for name, asked_s in _ASKED_S.items():
            arguments = [*name.split()[1:], *(out if name.startswith("hil run a") else [])]
            _spent_s(arguments)  # compiled kernels and files are in their caches from here on
            spent = [_spent_s(arguments) for _ in range(_TIMES)]
            print(f"{name:34}{min(spent):8.2f}{statistics.median(spent):8.2f}{asked_s:8.1f}")
        print(f"\n{'of one run, in this order':34}{'s':>8}")
        for part, part_s in _parts(Path(directory)):
            print(f"{part:34}{part_s:8.2f}")


def _spent_s(arguments: list[str]) -> float:
    before = _children_s()
    subprocess.run([_HIL, *arguments], check=True, stdout=subprocess.DEVNULL)
    return _children_s() - before


def _children_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _parts(directory: Path) -> list[tuple[str, float]]:
    """What `hil run acceptance` does, part by part, in this process."""
    found: list[tuple[str, float]] = []

    def timed(part: str, work: Callable[[], object]) -> object:
        start_s = time.process_time()
        result = work()
        found.append((part, time.process_time() - start_s))
        return result

    def imports() -> None:
        from hil.app.worker.lean_imports import import_python_can

        import_python_can()
        import hil.cli.commands.run  # noqa: F401

    timed("imports", imports)
    from hil.core.recording import Recording, read_recording
    from hil.engine import RunOutcome, RunRequest, load_bench, run_plan
    from reports import write_documents, write_junit
    from test_plans import load_plan

    plan = load_plan("acceptance")
    outcome = timed(
        "run, recorded and judged", lambda: run_plan(RunRequest(plan, load_bench("sim"), directory))
    )
    assert isinstance(outcome, RunOutcome)
    recording = timed("reading the recording", lambda: read_recording(outcome.recording))
    assert isinstance(recording, Recording)
    timed("junit.xml", lambda: write_junit(recording, outcome.result, directory / "junit.xml"))
    timed("report.html and report.pdf", lambda: write_documents(recording, outcome.result, directory))
    return found


if __name__ == "__main__":
    main()
