"""Runs of plans from pytest: the bench, a folder for each run, each plan once in a session.

Which bench a plan or a test is meant for.

Where the runs of pytest go: a numbered folder for each; a second session finds room beside the first.

It imports next to nothing, as the plugin that uses it does.

Runs of plans by the command: each plan once in a session, and none before the bench is safe again.

A run is a process of its own. Whatever ends a test while it lasts (a timeout, Ctrl-C) interrupts it, and
waits until it has left the bench safe. The locks are held by the run itself: they outlive a worker of xdist
that was killed, and go when the bench is safe.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import pytest

from hil.pytest_plugin._ran import Ran

_BENCH = "bench.toml"


def bench_for(config: pytest.Config, folder: Path) -> str | None:
    """A bench file's path, or the name of a shipped one."""
    given = config.getoption("--bench")
    if given:
        return _placed(given, config.invocation_params.dir)
    ini = config.getini("hil_bench")
    if ini:
        return _placed(ini, config.inipath.parent if config.inipath else config.rootpath)
    own = (place / _BENCH for place in (folder, config.invocation_params.dir))
    return next((str(file) for file in own if file.is_file()), None)


def refuse_unnamed_hardware(config: pytest.Config, found: str) -> None:
    """Raises:
    BadInputError: a bench.toml that no option names describes hardware.
    """
    if not config.getoption("--bench") and not config.getini("hil_bench"):
        from hil.engine.bench.bench_file import refuse_hardware

        refuse_hardware(Path(found))


def _placed(bench: str, base: Path) -> str:
    return str(base / bench) if bench.endswith(".toml") else bench


class Folders:
    """Numbered folders below a place: a new one for each run, or with `overwrite` the earlier ones."""

    def __init__(self, place: Path, *, overwrite: bool) -> None:
        self._place, self.overwrite = place, overwrite
        self._count = 0

    def next(self, name: str) -> Path:
        """The next run's folder: NAME-001 and so on; without `overwrite` it is made, as no one else's."""
        while True:
            self._count += 1
            folder = self._place / f"{name}-{self._count:03d}"
            if self.overwrite:
                return folder
            try:
                folder.mkdir(parents=True)
            except FileExistsError:
                continue  # of an earlier session, or of one beside this
            return folder


def leave_if_empty(folder: Path) -> None:
    """Remove the folder of a run that did not begin."""
    with contextlib.suppress(OSError):  # it holds something, or is not there
        folder.rmdir()


def folder_name(node: str) -> str:
    """A test's id as the name of a folder."""
    return "".join(character if character.isalnum() else "_" for character in node).strip("_")[-120:]


_OUTCOME, _STARTED = "outcome.json", "has-started"


class CutOffError(Exception):
    """The run of a plan was ended before it had a result, by a timeout or an interrupt of its test."""


def run_once(config: pytest.Config, node: str, start: Any) -> Ran:
    """A plan's run: in a session of xdist whichever worker comes first runs it, and all others wait for it.

    Args:
        start: runs it, given descriptors that the run has to hold.

    Raises:
        CutOffError: it was started in this session, and its worker ended before it did.
        HilError: it failed; the same for all workers.
    """
    place = _shared_place(config)
    if place is None:
        ran: Ran = start(())
        return ran
    folder = place / f"hil-{_short(node)}"
    folder.mkdir(exist_ok=True)
    with _locked(folder / "lock") as held:
        if (folder / _OUTCOME).is_file():
            return _stored(json.loads((folder / _OUTCOME).read_text("utf-8")))
        if (folder / _STARTED).exists():
            raise CutOffError("the run was cut off when its worker ended; a plan is run once in a session")
        (folder / _STARTED).touch()
        return _kept(folder, start, (held,))


def run_plan(
    config: pytest.Config,
    plan: str | Path,
    bench: str,
    folder: Path,
    *,
    variables: Mapping[str, float] | None = None,
    options: Mapping[str, str] | None = None,
    overwrite: bool,
    held: Sequence[int] = (),
) -> Ran:
    """A run by the command; of hardware one after the other, also with the workers of xdist.

    Raises:
        HilError: plan, bench or an option cannot be used, or the bench failed before it had a result.
        KeyboardInterrupt: the run was interrupted; the bench is safe.
        BaseException: whatever ended the test; the bench is safe.
    """
    from hil import notebook
    from hil.core.errors import BenchError, HilError, InterruptError
    from hil.core.result import RunResult

    words = [
        word for name, value in (options or {}).items() for word in (f"--{name.replace('_', '-')}", value)
    ]
    words += ["--overwrite"] if overwrite else []
    try:
        with _alone_on(config, bench) as bench_held:
            ran = notebook.run(
                plan, folder, bench, variables=dict(variables or {}), options=words, held=(*held, *bench_held)
            )
        return Ran(ran.result, folder)
    except InterruptError as error:
        raise KeyboardInterrupt(str(error)) from error  # it ends the session, as Ctrl-C does
    except HilError as error:
        stored = folder / "result.json"
        if not isinstance(error, BenchError) or not stored.is_file():
            leave_if_empty(folder)
            raise
        return Ran(RunResult.model_validate_json(stored.read_bytes()), folder, str(error))


@contextlib.contextmanager
def _alone_on(config: pytest.Config, bench: str) -> Iterator[tuple[int, ...]]:
    """Wait until no other worker's run holds the hardware of a bench; simulated ones are each run's own."""
    from hil.engine.bench.bench_file import load_bench

    place = _shared_place(config)
    if place is None or load_bench(bench).simulation is not None:
        yield ()
        return
    with _locked(place / f"hil-bench-{_short(bench)}.lock") as held:
        yield (held,)


def _shared_place(config: pytest.Config) -> Path | None:
    """The folder that all workers of a session of xdist share; None in a session without."""
    if not hasattr(config, "workerinput"):
        return None
    factory: Any = config._tmp_path_factory  # type: ignore[attr-defined]
    shared: Path = factory.getbasetemp().parent
    return shared


def _short(name: str) -> str:
    return hashlib.sha256(name.encode()).hexdigest()[:16]


@contextlib.contextmanager
def _locked(path: Path) -> Iterator[int]:
    """Hold a lock that passes to every process which inherits the descriptor; waits for it."""
    try:
        import fcntl
    except ImportError:  # Windows: xdist's workers have to be kept apart by --dist loadgroup
        yield os.open(path, os.O_RDWR | os.O_CREAT)
        return
    handle = os.open(path, os.O_RDWR | os.O_CREAT, 0o600)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX)
        yield handle
    finally:
        os.close(handle)


def _kept(folder: Path, start: Any, held: Sequence[int]) -> Ran:
    """Run it, and keep what became of it for the other workers."""
    from hil.core.errors import HilError

    try:
        ran: Ran = start(held)
    except HilError as error:
        _store(folder, {"error": type(error).__name__, "what": str(error)})
        raise
    except BaseException as error:
        _store(folder, {"error": CutOffError.__name__, "what": f"the run was cut off: {error}"})
        raise
    stored = {"result": ran.result.model_dump_json(), "folder": str(ran.folder), "trouble": ran.trouble}
    _store(folder, stored)
    return ran


def _store(folder: Path, outcome: Mapping[str, str]) -> None:
    whole = folder / f"{_OUTCOME}.new"
    whole.write_text(json.dumps(outcome), "utf-8")
    whole.replace(folder / _OUTCOME)


def _stored(outcome: Mapping[str, str]) -> Ran:
    """What another worker's run came to.

    Raises:
        CutOffError, HilError: what it ended with.
    """
    from hil.core import errors
    from hil.core.result import RunResult

    if "error" in outcome:
        kind = getattr(errors, outcome["error"], CutOffError)
        raise kind(outcome["what"])
    result = RunResult.model_validate_json(outcome["result"])
    return Ran(result, Path(outcome["folder"]), outcome["trouble"])
