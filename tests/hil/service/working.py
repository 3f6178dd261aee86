"""A real agent in a process of its own."""

from __future__ import annotations

import contextlib
import os
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tests.hil.service.served import HIL, ended, told_by

_BENCHES = Path(__file__).parents[3] / "benches"


def bench_called(name: str, folder: Path) -> Path:
    """The simulated bench under another name, with buses of its own."""
    shutil.copytree(_BENCHES, folder, dirs_exist_ok=True)
    text = (_BENCHES / "sim.toml").read_text()
    path = folder / f"{name}.toml"
    path.write_text(text.replace('name = "sim"', f'name = "{name}"', 1).replace('"sim/', f'"{name}/'))
    return path


class Working:
    """An agent; `told` is what it said when it was ready."""

    def __init__(self, process: subprocess.Popen[str], told: Any, data: Path) -> None:
        self.process, self.told, self.data = process, told, data

    def kill(self) -> None:
        self.process.kill()
        self.process.wait(10)

    def folder_of(self, run: int) -> Path:
        return self.data / "runs" / f"{run:06d}"


@contextlib.contextmanager
def working(
    url: str, data: Path, *benches: Path, state: Path, token: str = "", arguments: tuple[str, ...] = ()
) -> Iterator[Working]:
    """Start it and end it; it may be killed meanwhile."""
    process = started(url, data, *benches, state=state, token=token, arguments=arguments)
    try:
        yield Working(process, told_by(process), data)
    finally:
        ended(process)


def started(
    url: str, data: Path, *benches: Path, state: Path, token: str = "", arguments: tuple[str, ...] = ()
) -> subprocess.Popen[str]:
    """The process, whatever it says."""
    environment = {**os.environ, "HIL_STATE": str(state), "HIL_TOKEN": token}
    command = [*HIL, "bench", "agent", "--server", url, "--data", str(data), "--json", *arguments]
    command += [part for bench in benches for part in ("--bench", str(bench))]
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment)
