"""Options that are unknown, misspelt, missing, given twice, or that contradict each other."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from tests.bad_inputs.case import DONE, OPTIONS, REFUSED, Case
from tests.bad_inputs.commands import COMMANDS, USUAL, usual, with_other

_LONG = "x" * 5000
_TARGET = "c.peak_shaft_torque=120"


def option_cases() -> Iterator[Case]:
    """What can be typed wrongly."""
    for command in COMMANDS:
        yield _case(command, "a misspelt option", (*usual(command), "--jsn"))
        yield _case(command, "an option without its value", (*usual(command), "--out"))
    for tried, surplus in (
        ("an unknown option", ("--colour", "red")),
        ("a value for a switch", ("--json=yes",)),
        ("arguments too many", ("", "surplus")),
        ("an option of 5000 letters", (f"--{_LONG}",)),
    ):
        for command in ("export", "run"):
            yield _case(command, tried, (*usual(command), *surplus))
    for command in COMMANDS:
        if command != "schema":
            allowed = (DONE,) if command == "bench doctor" else (REFUSED,)  # it looks at the default bench
            yield _case(command, "no arguments", (), allowed)
    for command in ("simulate", "export"):  # others make a numbered folder
        arguments = USUAL[command]
        at = arguments.index("--out")
        yield _case(command, "no --out", arguments[:at] + arguments[at + 2 :])
    yield from _contradictions()
    yield from _of_hil()


def _contradictions() -> Iterator[Case]:
    yield _case("run", "a plan that there is not", with_other(usual("run"), "plan.yaml", "acceptence"))
    yield _case("run", "a bench that there is not", with_other(usual("run"), "bench.toml", "simm"))
    yield _case("run", "a plan of 5000 letters", with_other(usual("run"), "plan.yaml", _LONG))
    hardware = with_other(usual("run", "--model"), "bench.toml", "rear_axle_socketcan")
    yield _case("run", "--model with a bench of hardware", hardware)
    yield _case("run", "--yes with an empty name", (*usual("run"), "--yes", ""), (DONE, REFUSED))
    named = (*usual("run"), "--operator", "a\x1b[31m\nb")
    yield _case("run", "an operator with control characters", named, (DONE, REFUSED))
    for option in ("--operator", "--yes", "--confirm", "--accept-expired"):
        yield _case("run", f"{option} of 5000 letters", (*usual("run"), option, _LONG))
    yield _case("bench reset", "--by of 5000 letters", with_other(usual("bench reset"), "A. Tester", _LONG))
    yield _case(
        "evidence sign", "--by of 5000 letters", with_other(usual("evidence sign"), "A. Tester", _LONG)
    )
    yield _case("check", "a plan with an unknown step", usual("check"), prepare=_unknown_step)
    yield _case("report", "a folder without a recording", ("empty",), prepare=_empty_folder)
    yield _case("identify", "a segment that there is not", (*usual("identify"), "--segment", "nowhere"))
    yield _case("identify", "an input channel that there is not", (*usual("identify"), "--input", "nowhere"))
    yield _case("identify", "a method that there is not", (*usual("identify"), "--method", "magic"))
    bands = (*usual("identify"), "--from-hz", "20", "--to-hz", "2")
    yield _case("identify", "--from-hz above --to-hz", bands)
    yield _case("identify", "--from-hz above all that is excited", (*usual("identify"), "--from-hz", "400"))
    yield _case("design", "an objective that there is not", (*usual("design"), "--objective", "best"))
    yield _case("design", "a normalisation that there is not", (*usual("design"), "--normalisation", "x"))
    both = (*usual("design"), "--notch-hz", "11", "--lead-hz", "30")
    yield _case("design", "--notch-hz and --lead-hz", both, (DONE, REFUSED))
    named = (*usual("design"), "--name", "../x\x1b[31m")
    yield _case("design", "a name that is a path", named, (DONE, REFUSED))
    held = (*usual("diagnose"), "--holdout", "short.csv")
    yield _case("diagnose", "a recording held out of itself", held)
    yield _case("diagnose", "a recording twice", ("short.csv", *usual("diagnose")))
    yield _case("compare", "one run", with_other(usual("compare"), "done", "recording.mcap"))
    yield _case(
        "explain", "a target without a figure", with_other(usual("explain"), _TARGET, "c.peak_shaft_torque")
    )
    yield _case("explain", "a target of no criterion", with_other(usual("explain"), _TARGET, "x.y=1"))
    yield _case("explain", "a target that is no number", with_other(usual("explain"), _TARGET, f"{_TARGET}x"))
    yield _case("explain", "an effect that there is not", with_other(usual("explain"), "dead_time", "magic"))
    for hidden in ("backlash", "backlash=", "backlash=nan", "backlash=-1", "magic=1", "=1", "backlash=x"):
        yield _case("bench sim", f"--hide {hidden}", (*usual("bench sim"), "--hide", hidden))
    for seconds in ("nan", "0", "-1", "x"):  # a very long time is one that it serves
        yield _case("bench sim", f"--for {seconds}", (*usual("bench sim"), "--for", seconds))
    yield _case("bench sim", "a transport that there is not", (*usual("bench sim"), "--transport", "pigeon"))
    yield _case("bench sim", "--bench-file is the bench", (*usual("bench sim"), "--bench-file", "bench.toml"))
    for command in ("simulate", "export"):
        for ending in (".xyz", "", ".mcap", ".CSV.gz"):
            arguments = with_other(usual(command), "out.csv", f"out{ending}")
            yield _case(command, f"--out ends in '{ending}'", arguments)
    yield _case("schema", "of what there is not", ("plant",))
    yield _case("schema", "of nothing", ("",))


def _of_hil() -> Iterator[Case]:
    for tried, arguments in (
        ("a misspelt command", ("rum", "plan.yaml")),
        ("an unknown command", ("fly",)),
        ("an empty command", ("",)),
        ("an unknown option", ("--nonsense",)),
        ("a command in other letters", ("prüfe Ω",)),
        ("a command with control characters", ("a\x1b[31m\nb",)),
        ("a command of 5000 letters", (_LONG,)),
    ):
        yield _case("hil", tried, arguments)


def _case(
    command: str,
    tried: str,
    arguments: tuple[str, ...],
    allowed: tuple[int, ...] = (REFUSED,),
    prepare: object = None,
) -> Case:
    return Case(command, OPTIONS, tried, arguments, allowed, prepare)  # type: ignore[arg-type]


def _unknown_step(folder: Path) -> None:
    path = folder / "plan.yaml"
    path.write_text(path.read_text("utf-8").replace("chirp:", "chrip:"), "utf-8")


def _empty_folder(folder: Path) -> None:
    (folder / "empty").mkdir()
