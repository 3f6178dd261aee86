"""`python -m tests.faults [--write] [--only TEXT]`: tries all cells, one after the other."""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

from tests.faults.expected import FaultRow
from tests.faults.judging import wrong
from tests.faults.page import PAGE, page_of
from tests.faults.table import FAULTS
from tests.faults.trying import Outcome, execute, prepared

Cell = tuple[FaultRow, str, Outcome, list[str]]


def try_all(only: str, place: Path) -> list[Cell]:
    """Every cell whose fault or phase has this text."""
    cells: list[Cell] = []
    for fault in FAULTS:
        for phase in fault.phases:
            if only not in f"{fault.id} / {phase}":
                continue
            folder = place / f"{fault.id}-{phase}".replace(" ", "-")
            outcome = execute(fault, phase, folder)
            found = wrong(fault, phase, outcome, folder)
            cells.append((fault, phase, outcome, found))
            for line in found:
                print(f"{fault.id} / {phase}: {line}\n    {' '.join(outcome.said.split())[:300]}", flush=True)
    return cells


def main() -> int:
    """Try them, say what is wrong, write the page if asked to."""
    parser = argparse.ArgumentParser(prog="python -m tests.faults")
    parser.add_argument("--write", action="store_true", help="write docs/reference/faults.md")
    parser.add_argument("--only", default="", help="cells 'fault / phase' that have this text")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as directory, prepared(Path(directory)) as place:
        cells = try_all(options.only, place)
    failures = sum(bool(found) for *_, found in cells)
    print(f"{len(cells)} cells, {failures} wrong")
    if options.write and not options.only:
        PAGE.write_text(page_of(cells), "utf-8")
    return 1 if failures or not cells else 0


if __name__ == "__main__":
    sys.exit(main())
