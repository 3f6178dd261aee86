"""Locks between processes: held, named, and gone with whoever held them."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from hil.core.files.locks import HeldError, lock_named, lock_on, shared_place

HOLDING = """import sys, time
from pathlib import Path
from hil.core.files import locks
with getattr(locks, sys.argv[1])(Path(sys.argv[2]) if sys.argv[1] == "lock_on" else sys.argv[2]):
    print("held", flush=True)
    time.sleep(60)
"""
NAME = f"test bus {os.getpid()}"


@contextlib.contextmanager
def holding(kind: str, what: str) -> Iterator[subprocess.Popen[str]]:
    command = [sys.executable, "-c", HOLDING, kind, what]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout
            assert process.stdout.readline() == "held\n"
            yield process
        finally:
            process.send_signal(signal.SIGKILL)


@pytest.mark.parametrize("kind", ["lock_on", "lock_named"])
def test_another_process_is_refused_by_name_and_a_kill_frees_the_lock(kind: str, tmp_path: Path) -> None:
    lock = (lambda: lock_on(tmp_path)) if kind == "lock_on" else (lambda: lock_named(NAME))
    with holding(kind, str(tmp_path) if kind == "lock_on" else NAME) as process:
        with pytest.raises(HeldError) as refused, lock():
            pass
        if Path("/proc/locks").exists():
            assert str(refused.value).startswith(f"process {process.pid} (")
            assert "import sys, time" in str(refused.value)
    with lock(), pytest.raises(HeldError), lock():
        pass
    with lock():
        pass
    assert not list(shared_place().glob(f"eaxle-hil-{NAME.replace(' ', '_')}*"))
    assert not list(tmp_path.iterdir())


def test_what_is_not_there_cannot_be_locked(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError), lock_on(tmp_path / "nothing"):
        pass
