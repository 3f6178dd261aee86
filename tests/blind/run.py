"""Runs the blind set: `python -m tests.blind`."""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import shutil
import sys
import tempfile
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from functools import partial
from pathlib import Path

from tests.blind.casefiles import OpenFiles, drawn_case, open_answer, seal_answer, write_case
from tests.blind.diagnosing import Diagnose, by_command_line, says_nothing
from tests.blind.draws import draw
from tests.blind.scoring import Score, score
from tests.blind.specs import GROUPS, Spec, full_set, subset
from tests.blind.tables import as_markdown

_RESULTS = Path("docs/reference/blind-results.md")


def run_case(
    seed: int, spec: Spec, diagnose: Diagnose, keep: Path | None = None, length: float = 1.0
) -> Score:
    """Draw, measure, ask, open the answer, judge. With `keep`, what was drawn stays and is used again."""
    with tempfile.TemporaryDirectory(prefix="blind-") as place:
        drawn = Path(place) / "drawn"
        if keep is not None:
            name = spec.key.replace("/", "-").replace(":", "-")
            drawn = keep / f"seed-{seed}-length-{length:g}" / name
        files = drawn_case(drawn) or _draw(seed, spec, length, drawn)
        reply = diagnose(files, Path(place) / "out")
        kind, answer = open_answer(drawn)
        return score(spec, kind, answer, reply)


def _draw(seed: int, spec: Spec, length: float, directory: Path) -> OpenFiles:
    shutil.rmtree(directory, ignore_errors=True)
    directory.mkdir(parents=True)
    case = draw(seed, spec, length)
    files, answer = write_case(case, directory)
    seal_answer(directory, case.truth.kind, answer)
    return files


def run_all(
    seed: int,
    specs: Sequence[Spec],
    diagnose: Diagnose,
    jobs: int,
    keep: Path | None = None,
    length: float = 1.0,
) -> list[Score]:
    """Scores in the order of `specs`, from `jobs` processes; after Ctrl-C those that are there."""
    results: dict[Spec, Score] = {}
    with ProcessPoolExecutor(jobs, multiprocessing.get_context("spawn")) as pool:
        waiting = {pool.submit(run_case, seed, spec, diagnose, keep, length): spec for spec in specs}
        try:
            for done in as_completed(waiting):
                spec = waiting[done]
                results[spec] = done.result()
                _tell(results[spec], len(results), len(specs))
        except KeyboardInterrupt:
            pool.shutdown(wait=False, cancel_futures=True)
    return [results[spec] for spec in specs if spec in results]


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
    scores = run_all(options.seed, specs, diagnose, options.jobs, options.keep, options.length)
    wall = time.perf_counter() - start
    command = "python -m tests.blind " + " ".join(arguments if arguments is not None else sys.argv[1:])
    how = (
        f"Made by `{command.strip()}`: {len(scores)} cases, seed {options.seed}, {options.jobs} at a time "
        f"with {options.threads} threads each, {wall / 60:.0f} minutes. Sizes: gap before / noise floor on "
        "the channel that shows the effect best, after what a refit of the base parameters would take away: "
        f"large 10, clear 3, middle 1.8, edge 1.3. Recordings last {196.0 * options.length:g} s together."
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
    parser.add_argument("--jobs", type=int, default=2, help="cases at a time")
    parser.add_argument("--threads", type=int, default=1, help="threads of each diagnosis")
    parser.add_argument(
        "--length", type=float, default=1.0, help="of the recordings; below 1 for a quick look"
    )
    parser.add_argument("--keep", type=Path, help="directory of drawn cases, used again next time")
    parser.add_argument("--out", type=Path, default=_RESULTS, help="Markdown to write; a JSON goes beside it")
    parser.add_argument("--stand-in", action="store_true", help="do not ask hil diagnose: answer 'none'")
    return parser.parse_args(arguments)
