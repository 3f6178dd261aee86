"""The bench that is meant where none is named: the `bench.toml` of one's own folder, else the shipped `sim`.

One rule for commands and pytest: beside the plan, else in the current folder. Hardware is never driven
because its file lies there: it is named.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from hil.core.errors import BadInputError
from hil.core.files import is_file
from hil.engine.bench.bench_file import load_bench

OWN_BENCH = "bench.toml"


def found_bench(folders: Iterable[Path]) -> Path | None:
    """The bench file of the first of the folders that has one."""
    return next((folder / OWN_BENCH for folder in folders if is_file(folder / OWN_BENCH)), None)


def refuse_hardware(found: Path, option: str = "--bench") -> None:
    """Refuse to drive hardware that no one has named.

    Raises:
        BadInputError: the bench file that was found describes hardware, or cannot be used.
    """
    if load_bench(found).simulation is None:
        raise BadInputError(
            "describes hardware, which is driven only if it is named",
            where=str(found),
            fix=f"{option} {found} drives it; {option} sim is the simulated bench",
        )


def folders_of(plan: str | Path | None) -> list[Path]:
    """Where a bench file is looked for: beside the plan's file, then in the current folder."""
    beside = [Path(plan).parent] if plan is not None and is_file(Path(plan)) else []
    return [*beside, Path()]
