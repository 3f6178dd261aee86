"""Runs the blind set: `python -m tests.blind`."""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from tests.blind.diagnosing import Diagnose, by_command_line, says_nothing
from tests.blind.scoring import Score
from tests.blind.specs import GROUPS, Spec, full_set, subset
from tests.blind.spread import Asked, CaseFiles, spread
from tests.blind.tables import as_markdown

_RESULTS = Path("docs/reference/blind-results.md")
_WORK = Path("out/blind")


def _tell(one: Score, number: int, total: int) -> None:
    mark = "right" if one.right else "WRONG"
    said = one.failure or f"{one.verdict} {' + '.join(one.named)}"
    print(
        f"[{number}/{total}] {mark} {one.key} ({one.kind}): {' + '.join(one.hidden) or '-'} -> {said}; "
        f"gap/noise {one.worst_gap:.2f}; {one.processor_s:.0f} s",
        file=sys.stderr,
        flush=True,
    )


def main(arguments: Sequence[str] | None = None) -> int:
    """Run what the options ask for and write the results."""
    options = _options(arguments)
    there = full_set()
    specs = [s for s in there if _wanted(s, options)]
    if options.cases:
        specs = subset(specs, options.cases, options.seed)
    if not specs:
        print("no case fits these options", file=sys.stderr)
        return 2
    for name in ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ[name] = "1"
    diagnose: Diagnose = (
        says_nothing if options.stand_in else partial(by_command_line, threads=options.threads)
    )
    start = time.perf_counter()
    who = "says nothing" if options.stand_in else f"hil diagnose, threads: {options.threads}"
    asked = Asked(options.seed, tuple(specs), diagnose, who, options.keep, options.length)
    if not options.resume:
        CaseFiles(options.work, asked).clear()

    def tell(score: Score, number: int) -> None:
        _tell(score, number, len(specs))

    try:
        scores = spread(asked, options.work, options.jobs, options.scheduler, tell)
    except KeyboardInterrupt:
        print(f"interrupted; scores are in {options.work}; go on with --resume", file=sys.stderr)
        return 130
    wall = time.perf_counter() - start
    if len(scores) < len(specs):
        print(
            f"{len(scores)} of {len(specs)} cases are in {options.work}; go on with --resume", file=sys.stderr
        )
        return 130
    command = "python -m tests.blind " + " ".join(arguments if arguments is not None else sys.argv[1:])
    last = "the last part " if options.resume else ""
    how = (
        f"Made by `{command.strip()}`: {len(scores)} cases, seed {options.seed}, {options.jobs} at a time "
        f"with {options.threads} threads each, {last}{wall / 60:.0f} minutes. "
        "Sizes: gap before / noise floor on the channel that shows the effect best, after what a refit of "
        "the base parameters would take away: large 10, clear 3, middle 1.8, edge 1.3. "
        f"Recordings last {196.0 * options.length:g} s together."
    )
    page = as_markdown(scores, how)
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.write_text(page, encoding="utf-8")
    data = {"seed": options.seed, "command": command, "cases": [s.as_json() for s in scores]}
    options.out.with_suffix(".json").write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
    print(page)
    return 0


def _wanted(spec: Spec, options: argparse.Namespace) -> bool:
    if options.group and spec.group not in options.group:
        return False
    if options.size and spec.size not in options.size:
        return False
    forms = {spec.subject, spec.subject.split(":")[0].split("@")[0], spec.subject.split("@")[0]}
    return not options.only or bool(forms & {*options.only})


def _options(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.blind", description=__doc__)
    parser.add_argument("--seed", type=int, default=1, help="another seed, other plants and noise")
    parser.add_argument("--cases", type=int, help="about this many, in the full set's proportions")
    parser.add_argument("--group", action="append", choices=GROUPS, help="only this group; may be repeated")
    parser.add_argument(
        "--only",
        action="append",
        metavar="EFFECT",
        help="only this effect in all its forms, or one form (backlash:damped); may be repeated",
    )
    parser.add_argument("--size", action="append", help="only large, clear, middle or edge; may be repeated")
    parser.add_argument("--jobs", type=int, default=2, help="cases at a time; 0: in this process")
    parser.add_argument("--scheduler", default="", help="of dask.distributed, whose workers take the cases")
    parser.add_argument("--work", type=Path, default=_WORK, help="directory of the scores as they come")
    parser.add_argument("--resume", action="store_true", help="only cases that have no score in --work yet")
    parser.add_argument("--threads", type=int, default=1, help="threads of each diagnosis")
    parser.add_argument(
        "--length", type=float, default=1.0, help="of the recordings; below 1 for a quick look"
    )
    parser.add_argument("--keep", type=Path, help="directory of drawn cases, used again next time")
    parser.add_argument("--out", type=Path, default=_RESULTS, help="Markdown to write; a JSON goes beside it")
    parser.add_argument("--stand-in", action="store_true", help="do not ask hil diagnose: answer 'none'")
    return parser.parse_args(arguments)
