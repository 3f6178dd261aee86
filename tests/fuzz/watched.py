"""Which modules are watched for the code that an input reaches."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

_ROOT = Path(__file__).parents[2]
PACKAGES = ("test_plans", "hil.core", "hil.engine", "drivers")
ON_A_BENCH = ("drivers",)  # there the plant is compiled, with constants of all the others
_COMPILED = ("hil.core.effects", "hil.core.runtime.compiled", "hil.core.chain")  # beside those that say so
#: There atheris keeps every block of a file that is compared: a megabyte an input.
_KEPT = ("hil.core.recording._mcap_walk",)


def left_alone() -> list[str]:
    """Modules that are not to be watched: what numba compiles, and the floors that no one watches.

    atheris watches the whole of a top-level package, but for the modules that it gets by name.
    """
    found = []
    for package in {name.partition(".")[0] for name in PACKAGES}:
        for file in sorted((_ROOT / package).rglob("*.py")):
            name = ".".join(file.relative_to(_ROOT).with_suffix("").parts).removesuffix(".__init__")
            compiled = "hil.core.runtime.compiled import" in file.read_text(encoding="utf-8")
            if compiled or _below(name, (*_COMPILED, *_KEPT)) or not _below(name, PACKAGES):
                found.append(name)
    return found


def _below(name: str, packages: Sequence[str]) -> bool:
    return any(f"{name}.".startswith(f"{package}.") for package in packages)
