"""`python -m tests.process_faults [--write] [--only TEXT]`: all cells, one after the other."""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from tests.process_faults.judging import wrong
from tests.process_faults.trying import FAULTS, PHASES, ROOT, Fault, Outcome, execute, packages

PAGE = ROOT / "docs" / "reference" / "process-faults.md"
MOST_REPEATS = 4
_SAFE = {"confirmed": "safe", "not_confirmed": "not confirmed", "not_needed": "not armed"}
_INTRODUCTION = """\
# Faults of processes

Made by `make process-faults` (`python -m tests.process_faults --write`), in real time: `hil run` at a
terminal, the process that holds the bench for it, and `hil bench sim`; one of them is killed (SIGKILL) or
frozen (SIGSTOP) in one phase.

A cell says: exit code · for how long the RMCU went on asking the inverter for torque after the fault, ms,
by the stand-in's own stamps (where torque was on) · what the run says of the safe state, in result.json or,
where the command was killed, in its recording. A command that is killed has no exit code of its own (-9);
one that was frozen goes on when the run has ended. Frozen processes are noticed after 2 s (`hung_after_s`,
`alone_after_s`); where it is the process that holds the bench, its requests stop at once, and with them the
torque. Every cell also has to say what happened, to leave no process behind, no traceback, and a recording
that lacks at most its last 0.5 s of what the stand-in had sent. A run that ended before its phase, as one
does in which the machine stood still, is repeated; so is one that lacks more while the disk kept another
file waiting for over 0.25 s.
"""

Cell = tuple[Fault, str, Outcome, list[str]]


def try_all(only: str, place: Path) -> tuple[list[Cell], int]:
    """Every cell whose fault or phase has this text; how many runs were repeated."""
    cells: list[Cell] = []
    repeats = 0
    for fault in FAULTS:
        for phase in fault.phases:
            if only not in f"{fault.title} / {phase}":
                continue
            for attempt in range(MOST_REPEATS):
                outcome = execute(fault, phase, place / f"{len(cells)}-{attempt}")
                if outcome is not None:
                    break
                repeats += 1
            assert outcome is not None, f"{fault.title} / {phase}: no run came so far"
            found = wrong(fault, phase, outcome)
            cells.append((fault, phase, outcome, found))
            print(f"{fault.title} / {phase}: {_cell(outcome, found)}", flush=True)
            if found:
                print(f"    {' '.join(outcome.said.split())[-600:]}", flush=True)
    return cells, repeats


def page_of(cells: Sequence[Cell], repeats: int) -> str:
    """The whole page."""
    rows: dict[str, dict[str, str]] = {}
    for fault, phase, outcome, found in cells:
        rows.setdefault(fault.title, {})[phase] = _cell(outcome, found)
    failures = sum(bool(found) for *_, found in cells)
    head = f"{len(rows)} faults, {len(cells)} cells, {failures} wrong; {repeats} runs were repeated.\n"
    table = "| fault | " + " | ".join(PHASES) + " |\n|---|" + "---|" * len(PHASES) + "\n"
    for title, found_in in rows.items():
        table += f"| {title} | " + " | ".join(found_in.get(phase, "") for phase in PHASES) + " |\n"
    return "\n".join([_INTRODUCTION, head, table])


def _cell(outcome: Outcome, found: list[str]) -> str:
    torque = [] if np.isnan(outcome.torque_s) else [f"{1e3 * outcome.torque_s:.0f}"]
    safe = _SAFE[outcome.result.safe_state] if outcome.result else "no result"
    said = " · ".join([str(outcome.code), *torque, safe])
    return f"**{said}: {'; '.join(found)}**" if found else said


def main() -> int:
    """Try them, say what is wrong, write the page if asked to."""
    parser = argparse.ArgumentParser(prog="python -m tests.process_faults")
    parser.add_argument("--write", action="store_true", help=f"write {os.path.relpath(PAGE, ROOT)}")
    parser.add_argument("--only", default="", help="cells 'fault / phase' that have this text")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as directory, packages(Path(directory)):
        cells, repeats = try_all(options.only, Path(directory))
    failures = sum(bool(found) for *_, found in cells)
    print(f"{len(cells)} cells, {failures} wrong, {repeats} runs repeated")
    if options.write and not options.only:
        PAGE.write_text(page_of(cells, repeats), "utf-8")
    return 1 if failures or not cells else 0


if __name__ == "__main__":
    sys.exit(main())
