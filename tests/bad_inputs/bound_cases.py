"""Files without end, and files that are far too large, too deep or have too many mistakes.

Each is tried with a limit on the memory of the process. What a command needs then stands in
docs/reference/bounds.md.
"""

from __future__ import annotations

import functools
import os
from collections.abc import Callable, Iterator
from pathlib import Path

from tests.bad_inputs.case import BOUNDS, FAILED, REFUSED, Case
from tests.bad_inputs.commands import FILE_ARGUMENTS, READ_ELSEWHERE, usual

ADDRESSES_KB = 4_000_000  # virtual memory: threads and compiled code reserve more than they use
_LIMITED = f'ulimit -v {ADDRESSES_KB}; exec "$@"'
_PARTS, _MISTAKES, _COLUMNS, _LARGE_BYTES = 60_000, 20_000, 150_000, 3_000_000_000

#: command, what names the file, the file in a case's folder, arguments beside the usual ones
_FURTHER = (
    ("report", "DIR's result.json", "done/result.json", ()),
    ("evidence verify", "DIR's result.json", "done/result.json", ("done",)),
    ("tune", "--free", "free.toml", ("--free", "free.toml")),
    ("replay", "--segments", "segments.json", ("--segments", "segments.json")),
    ("run", "the bench's DBC", "rmcu.dbc", ()),
    ("run", "the bench's model", "model.toml", ()),
)


def bound_cases() -> Iterator[Case]:
    """Every file argument of every command with a file that must not be read whole."""
    for command, argument, name, _ in FILE_ARGUMENTS:
        shapes = _SHAPES if (command, argument) not in READ_ELSEWHERE else _SHAPES[:1]
        written = _WRITTEN.get(Path(name).suffix, ()) if (command, argument) not in READ_ELSEWHERE else ()
        for what, change in (*shapes, *written):
            yield _case(
                command, argument, what, usual(command, argument), functools.partial(_on, name, change)
            )
    for command, argument, name, more in _FURTHER:
        arguments = more if command == "evidence verify" else (*usual(command), *more)
        for what, change in _SHAPES:
            yield _case(command, argument, what, arguments, functools.partial(_on, name, change))


def _case(
    command: str, argument: str, what: str, arguments: tuple[str, ...], prepare: Callable[[Path], None]
) -> Case:
    # To verify, a file that cannot be read is evidence that is not there; a report is made again.
    allowed = {"evidence verify": (FAILED, REFUSED), "report": (0, FAILED, REFUSED)}.get(command, (REFUSED,))
    return Case(command, BOUNDS, f"{argument} is {what}", arguments, allowed, prepare, _LIMITED)


def _on(name: str, change: Callable[[Path], None], folder: Path) -> None:
    path = folder / name
    path.unlink(missing_ok=True)
    change(path)


def _make_device(path: Path) -> None:
    path.symlink_to("/dev/zero")


def _make_large(path: Path) -> None:
    """A file of holes: it takes no room on the disk."""
    with path.open("wb") as file:
        file.truncate(_LARGE_BYTES)


def _make_deep_toml(path: Path) -> None:
    path.write_text("a" + ".a" * _PARTS + " = 1\n", "utf-8")


def _make_wrong_toml(path: Path) -> None:
    path.write_text("".join(f"x{k} = {k}\n" for k in range(_MISTAKES)), "utf-8")


def _make_deep_yaml(path: Path) -> None:
    path.write_text("a: " + "[" * _PARTS, "utf-8")


def _make_wrong_yaml(path: Path) -> None:
    path.write_text("".join(f"x{k}: {k}\n" for k in range(_MISTAKES)), "utf-8")


def _make_wide_csv(path: Path) -> None:
    row = ",".join(str(k) for k in range(_COLUMNS))
    path.write_text(f"time_s,{row}\n0,{row}\n", "utf-8")


_SHAPES: tuple[tuple[str, Callable[[Path], None]], ...] = (
    ("a device", _make_device),
    ("a pipe", os.mkfifo),
    (f"{_LARGE_BYTES / 1e9:g} GB long", _make_large),
)
_WRITTEN: dict[str, tuple[tuple[str, Callable[[Path], None]], ...]] = {
    ".toml": (
        (f"a key of {_PARTS} parts", _make_deep_toml),
        (f"{_MISTAKES} unknown keys", _make_wrong_toml),
    ),
    ".yaml": (
        (f"{_PARTS} lists in each other", _make_deep_yaml),
        (f"{_MISTAKES} unknown keys", _make_wrong_yaml),
    ),
    ".csv": ((f"a table of {_COLUMNS} columns", _make_wide_csv),),
}
