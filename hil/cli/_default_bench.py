"""Which bench a command takes, and that it says so where nobody has named one."""

from __future__ import annotations

from hil.cli._streams import complain
from hil.engine import DEFAULT_BENCH
from hil.engine.bench.found_bench import folders_of, found_bench, refuse_hardware


def bench_or_own(given: str, plan: str | None = None, *, drives: bool = False) -> str:
    """The bench that is given, else the `bench.toml` beside the plan or in the current folder, else `sim`.

    Args:
        given: file or name; '' if none is.
        plan: file or name.
        drives: whether the command moves what is at the bench: hardware must be named then.

    Raises:
        BadInputError: a bench.toml was found that cannot be used, or that describes hardware.
    """
    if given:
        return given
    found = found_bench(folders_of(plan))
    if found is None:
        return DEFAULT_BENCH
    if drives:
        refuse_hardware(found)
    complain("note", f"the bench is {found}; --bench names another")
    return str(found)
