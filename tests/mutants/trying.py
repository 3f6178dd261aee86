"""Runs tests in forks of a process that has the heavy libraries already: a second a mutant, not ten."""

from __future__ import annotations

import importlib
import os
import resource
import shutil
import signal
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any, TypeAlias

#: Third-party only: the project itself is imported in the fork, with the fault in it.
_HEAVY = (
    *("numpy", "scipy.signal", "scipy.optimize", "scipy.linalg", "scipy.interpolate", "scipy.integrate"),
    *("numba", "pandas", "pyarrow.parquet", "pydantic", "can", "canopen", "cantools", "yaml", "asammdf"),
    *("mcap.reader", "mcap.writer", "jsonschema", "typer", "rich", "jinja2", "tomli_w"),
    *("pytest", "hypothesis", "numpy.testing"),
)
#: Packages whose constants are in compiled functions of others.
_BELOW = ("hil/core/", "hil/plant/", "sim_backend/")
#: A file with a fault, and what it was: nothing of it is compiled.
Unseen: TypeAlias = tuple[Path, bytes]
#: Where a fork says which test failed.
_TOLD = ".mutants-told"
_MEMORY = 8 * 1024**3
_STARTING_S = 60.0  # a process that a test starts may have to compile what the fault is imported by
#: A test that fails without the fault, too, tells nothing of it: how often such a mutant is tried.
_TRIES = 2


def import_heavy_libraries() -> None:
    """Once, before any fork."""
    for name in _HEAVY:
        importlib.import_module(name)


class Trial:
    """Puts faults into files below `root` and runs tests there."""

    def __init__(self, root: Path) -> None:
        self._root = root
        self._stamp = int(time.time()) - 1_000_000

    def notices(self, file: str, mutated: str, tests: Sequence[str], expected_s: float) -> str:
        """`failed`, `timeout` or `crashed`: the tests notice the fault; `` : they pass.

        On a busy machine a test in real time trips without a fault: what fails is run once more without it.
        """
        for _ in range(_TRIES):
            said = self._with_fault(file, mutated, tests, expected_s)
            if not said or not self._run(self._telling(tests), _STARTING_S + 4.0 * expected_s):
                return said
        return ""

    def _with_fault(self, file: str, mutated: str, tests: Sequence[str], expected_s: float) -> str:
        path = self._root / file
        source = path.read_bytes()
        try:
            path.write_text(mutated, encoding="utf-8")
            self._renew(path)
            unseen = None if _feeds_compiled(file, source) else (path, source)
            return self._run(tests, _STARTING_S + 4.0 * expected_s, unseen)
        finally:
            path.write_bytes(source)
            self._renew(path)

    def check(self, tests: Sequence[str], expected_s: float) -> None:
        """Run `tests` on the code as it is.

        Raises:
            RuntimeError: they do not pass, so that they could not tell a fault.
        """
        said = self._run(tests, _STARTING_S + 4.0 * expected_s)
        if said:
            raise RuntimeError(f"the tests do not pass without a fault ({said}): {' '.join(tests)}")

    def _telling(self, tests: Sequence[str]) -> Sequence[str]:
        """The test that failed; all of them if none did, as where they took too long."""
        told = self._root / _TOLD
        return [told.read_text("utf-8")] if told.is_file() else tests

    def _renew(self, path: Path) -> None:
        """A time of its own for every content: Python takes compiled files by size and second."""
        self._stamp += 1
        os.utime(path, (self._stamp, self._stamp))

    def _run(self, tests: Sequence[str], patience_s: float, unseen: Unseen | None = None) -> str:
        (self._root / _TOLD).unlink(missing_ok=True)
        pid = os.fork()
        if pid == 0:
            _be_the_tests(self._root, tests, unseen)
        status = _waited(pid, patience_s)
        shutil.rmtree(self._root / ".mutants-tmp", ignore_errors=True)
        if status is None:
            return "timeout"
        if os.WIFSIGNALED(status):
            return "crashed"
        return "failed" if os.WEXITSTATUS(status) != 0 else ""


def _waited(pid: int, patience_s: float) -> int | None:
    """Wait status, or None: the fork and its own children were ended after `patience_s`."""
    end = time.monotonic() + patience_s
    while time.monotonic() < end:
        done, status = os.waitpid(pid, os.WNOHANG)
        if done:
            return status
        time.sleep(0.01)
    os.killpg(pid, signal.SIGKILL)
    os.waitpid(pid, 0)
    return None


def _feeds_compiled(file: str, source: bytes) -> bool:
    """Whether compiled functions may hold something of a file: they take from their own, and from below."""
    return file.startswith(_BELOW) or b"hil.core.runtime.compiled import" in source


def _leave_compiled(unseen: Unseen) -> None:
    """Compiled functions stay good though a file that theirs import has changed: the fault is not in them."""
    from hil.core.runtime import compiled

    path, source = unseen
    content = compiled._content
    compiled._content = lambda file: source.decode() if file == path else content(file)  # type: ignore[assignment]


class _Teller:
    """A pytest plugin: the test that failed, by its name in a file."""

    def __init__(self, told: Path) -> None:
        self._told = told

    def pytest_runtest_logreport(self, report: Any) -> None:
        if report.failed:
            self._told.write_text(report.nodeid, encoding="utf-8")


def _be_the_tests(root: Path, tests: Sequence[str], unseen: Unseen | None) -> None:
    """In the fork: a process group of its own, no output, and never back."""
    code = 3
    try:
        os.setsid()
        os.chdir(root)
        silent = os.open(os.devnull, os.O_RDWR)
        for stream in (0, 1, 2):
            os.dup2(silent, stream)
        resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, _MEMORY))
        sys.dont_write_bytecode = True
        os.environ["PYTHONDONTWRITEBYTECODE"] = "1"
        if unseen is not None:
            _leave_compiled(unseen)
        import pytest

        options = ["-x", "-q", "-p", "no:cacheprovider", f"--basetemp={root / '.mutants-tmp'}"]
        options += ["-W", "ignore::pytest.PytestAssertRewriteWarning"]  # hypothesis is there already
        code = int(pytest.main([*options, *tests], plugins=[_Teller(root / _TOLD)]))
    finally:
        os._exit(code)
