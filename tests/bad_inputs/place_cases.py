"""Places that cannot be written, that hold results, or that are the input itself."""

from __future__ import annotations

import functools
from collections.abc import Iterator
from pathlib import Path

from tests.bad_inputs.case import BENCH, DONE, PLACES, REFUSED, Case
from tests.bad_inputs.commands import WRITING, usual, with_other

_OUTPUT = {"simulate": "out.csv", "export": "out.csv", "evidence recover": "out.mcap"}
_RESULTS = {
    "run": "recording.mcap",
    "report": "report.html",
    "identify": "frf.csv",
    "design": "controller.toml",
    "diagnose": "diagnosis.json",
    "replay": "recording.mcap",
    "compare": "comparison.json",
    "explain": "targets.json",
    "campaign": "started.json",
}

_ODD_NAMES = (
    ("--out in other letters", "größe Ω 日本"),
    ("--out with spaces", "a b  c"),
    ("--out like an option", "./--json"),
)


def place_cases() -> Iterator[Case]:
    """Every command that writes, with every place where it must not."""
    for command in WRITING:
        there = _OUTPUT.get(command, "out")
        ending = Path(there).suffix
        for tried, place, prepare in (
            ("--out is under a file", f"plan.yaml/out{ending}", None),
            ("--out is where nothing can be made", f"/proc/nonexistent/out{ending}", None),
            ("--out is /dev/full", "/dev/full", None),
            ("--out has a name of 300 letters", "x" * 300 + ending, None),
            ("--out is empty", "", None),
            ("--out is a link to nowhere", f"link{ending}", functools.partial(_link, f"link{ending}")),
        ):
            allowed = (DONE, REFUSED) if "link" in tried else (REFUSED,)
            yield _case(command, tried, with_other(usual(command), there, place), allowed, prepare)
        if ending:
            yield _case(
                command, "--out is a directory", usual(command), (REFUSED,), functools.partial(_folder, there)
            )
            yield _case(command, "--out exists", usual(command), (REFUSED,), functools.partial(_file, there))
        else:
            yield _case(
                command, "--out is a file", usual(command), (REFUSED,), functools.partial(_file, there)
            )
            held = functools.partial(_results, there, _RESULTS[command])
            yield _case(command, "--out holds results", usual(command), (REFUSED,), held)
    yield from _inputs_as_outputs()
    for tried, name in _ODD_NAMES:
        for command in ("export", "design"):
            there = _OUTPUT.get(command, "out")
            arguments = with_other(usual(command), there, name + Path(there).suffix)
            yield _case(command, tried, arguments, (DONE,))


def _inputs_as_outputs() -> Iterator[Case]:
    """With --overwrite too: an input is never written over."""
    for extra in ((), ("--overwrite",)):
        said = " with --overwrite" if extra else ""
        for command, place, what in (
            ("simulate", "short.csv", "--out is --input"),
            ("export", "short.csv", "--out is the recording"),
            ("diagnose", ".", "--out is the folder of the model"),
            ("run", "done", "--out is the folder of its --model"),
        ):
            there = _OUTPUT.get(command, "out")
            arguments = (*with_other(usual(command), there, place), *extra)
            if command == "export":
                arguments = with_other(arguments, "recording.mcap", "short.csv")
            if command == "run":
                if extra:
                    continue  # replaces the run in `done`, as it is told to
                what = "--out is the folder of an earlier run"
            yield _case(command, what + said, arguments)


def _case(
    command: str,
    tried: str,
    arguments: tuple[str, ...],
    allowed: tuple[int, ...] = (REFUSED,),
    prepare: object = None,
) -> Case:
    # A device without room is the machine's fault, not the input's.
    codes = (*allowed, BENCH) if "/dev/full" in arguments else allowed
    return Case(command, PLACES, tried, arguments, codes, prepare)  # type: ignore[arg-type]


def _file(name: str, folder: Path) -> None:
    (folder / name).write_text("mine\n", "utf-8")


def _folder(name: str, folder: Path) -> None:
    (folder / name).mkdir()


def _link(name: str, folder: Path) -> None:
    (folder / name).symlink_to("nowhere/at/all")


def _results(name: str, result: str, folder: Path) -> None:
    (folder / name).mkdir()
    (folder / name / result).write_text("mine\n", "utf-8")
