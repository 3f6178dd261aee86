"""Files that are missing, of another kind, or broken, for every argument that names one."""

from __future__ import annotations

import functools
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

from tests.bad_inputs import inputs
from tests.bad_inputs.case import DONE, FAILED, FILES, REFUSED, Case
from tests.bad_inputs.commands import FILE_ARGUMENTS, READ_ELSEWHERE, usual, with_other

_MANGLED: tuple[tuple[str, Callable[[Path], None]], ...] = (
    ("binary", inputs.make_binary),
    ("empty", inputs.make_empty),
    ("a directory", inputs.make_directory),
    ("text of another kind", inputs.make_text),
)
_DAMAGED: tuple[tuple[str, Callable[[Path], None]], ...] = (
    ("cut in half", inputs.cut),
    ("with flipped bits", inputs.flip_bits),
)
_NAMES = ("größe Ω 日本{}", "x" * 300 + "{}", "a\nb\x1b[31m{}")

_TABLES: dict[str, Callable[[list[str]], list[str]]] = {
    "no header": lambda lines: lines[1:],
    "a word among its numbers": lambda lines: [*lines[:50], "x" + lines[50], *lines[51:]],
    "time that runs backwards": lambda lines: [lines[0], *reversed(lines[1:])],
    "only NaN": lambda lines: _each(lines, lambda line: "nan" + "," * line.count(",")),
    "infinite values": lambda lines: _each(lines, lambda line: ",".join(["inf"] * len(line.split(",")))),
    "three samples": lambda lines: lines[:4],
    "a header alone": lambda lines: lines[:1],
    "rows that are too short": lambda lines: _each(lines, lambda line: line.partition(",")[0]),
    "no torque reference": lambda lines: [lines[0].replace("motor_torque_ref_nm", "x"), *lines[1:]],
}

_FOR_ALL = ("only NaN", "three samples", "no torque reference")


def file_cases() -> Iterator[Case]:
    """Every file argument of every command with what it cannot use."""
    for command, argument, name, other in FILE_ARGUMENTS:
        arguments = usual(command, argument)
        swap = functools.partial(_swap, name, other)
        # To `hil evidence verify` a file that cannot be read is evidence that is not there.
        allowed = (FAILED, REFUSED) if command == "evidence verify" else (REFUSED,)
        yield _case(command, f"{argument} is {other} by name of {name}", arguments, swap, allowed)
        missing = f"missing{Path(name).suffix}"
        yield _case(command, f"{argument} is missing", with_other(arguments, name, missing))
        # Where another command reads the same kind of file, one look is enough.
        again = (command, argument) in READ_ELSEWHERE
        for what, mangle in _MANGLED[:1] if again else _MANGLED:
            yield _case(
                command, f"{argument} is {what}", arguments, functools.partial(_on, name, mangle), allowed
            )
        for what, damage in () if again else _DAMAGED:
            # What is left of a text can still be right, and of a recording much can be read.
            harm = functools.partial(_on, name, damage)
            yield _case(command, f"{argument} is {what}", arguments, harm, (DONE, FAILED, REFUSED))
        for pattern in _NAMES if argument in ("PLAN", "RECORDING") and not again else ():
            none = pattern.format(Path(name).suffix)
            shown = repr(none) if len(none) < 30 else "a name of 300 letters"
            yield _case(command, f"{argument} is missing: {shown}", with_other(arguments, name, none))
    yield from _recordings()
    yield from _bench_parts()


def _recordings() -> Iterator[Case]:
    """Tables whose text is right but whose numbers are not."""
    for what, change in _TABLES.items():
        for command in ("identify", "simulate") if what in _FOR_ALL else ("simulate",):
            arguments = with_other(usual(command), "recording.mcap", "short.csv")
            allowed = (DONE, REFUSED) if (what, command) == ("three samples", "simulate") else (REFUSED,)
            yield _case(
                command, f"the table has {what}", arguments, functools.partial(_with_lines, change), allowed
            )


def _bench_parts() -> Iterator[Case]:
    """The files that a bench file names."""
    for part, other in (
        ("rmcu.dbc", "rcs_dyno.eds"),
        ("rcs_dyno.eds", "rmcu.dbc"),
        ("model.toml", "plan.yaml"),
    ):
        key = {"rmcu.dbc": "[rmcu] dbc", "rcs_dyno.eds": "[dyno] eds", "model.toml": "[simulation] model"}[
            part
        ]
        for what, mangle in (_MANGLED[0], ("missing", Path.unlink)):
            yield _case(
                "run", f"the bench's {key} is {what}", usual("run"), functools.partial(_on, part, mangle)
            )
        swap = functools.partial(_swap, part, other)
        yield _case("run", f"the bench's {key} is {other}", usual("run"), swap)


def _case(
    command: str,
    tried: str,
    arguments: tuple[str, ...],
    prepare: Callable[[Path], None] | None = None,
    allowed: tuple[int, ...] = (REFUSED,),
) -> Case:
    return Case(command, FILES, tried, arguments, allowed, prepare)


def _on(name: str, change: Callable[[Path], None], folder: Path) -> None:
    change(folder / name)


def _swap(name: str, other: str, folder: Path) -> None:
    shutil.copy(folder / other, folder / name)


def _with_lines(change: Callable[[list[str]], list[str]], folder: Path) -> None:
    path = folder / "short.csv"
    path.write_text("\n".join(change(path.read_text("utf-8").splitlines())) + "\n", "utf-8")


def _each(lines: list[str], change: Callable[[str], str]) -> list[str]:
    """The header as it is, every row changed."""
    return [lines[0], *map(change, lines[1:])]
