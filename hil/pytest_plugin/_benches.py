"""Which bench a plan or a test is meant for."""

from __future__ import annotations

from pathlib import Path

import pytest

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
