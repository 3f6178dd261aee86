"""Tries the mutants of packages in a copy of the repository: `python -m tests.mutants`."""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from tests.mutants.again import not_noticed_before
from tests.mutants.covering import Coverage, covered, shown_by
from tests.mutants.mutating import Mutant, difference, drawn
from tests.mutants.page import Outcome, Tried, as_markdown
from tests.mutants.trying import Trial, import_heavy_libraries

_RESULTS = Path("docs/reference/mutants.md")
_EXPLAINED = Path(__file__).with_name("explained.toml")
#: Package: the tests that are to notice its faults.
TESTS = {
    "test_plans.metrics": (
        "tests/test_plans/metrics",
        *(
            f"tests/test_plans/test_{name}.py"
            for name in ("judging", "criteria", "registry", "schema", "plan")
        ),
    ),
    "hil.core": (
        "tests/hil/core",
        "tests/test_plans",
        "tests/hil/plant",
        "tests/drivers",
        "tests/sim_backend",
    ),
    "hil.engine": ("tests/hil/engine", "tests/drivers"),
    "safety": ("tests/hil/engine", "tests/drivers", "tests/faults", "tests/process_faults"),
}
#: What is no package but a set of files: limits, interlocks, the emergency stop, the way to the safe state
#: and who watches it.
FILES = {
    "safety": (
        *(
            f"hil/engine/{name}.py"
            for name in (
                *("bench/ranges", "bench/range_scan", "bench/computed_channels"),
                *("bench/bench_lock", "run/limits", "run/zero", "run/hold", "run/operator"),
                *("run/run_monitoring", "run/arming", "run/safety"),
                *("stop/emergency_stop", "stop/stopping", "process/supervisor"),
                *("process/hardware_process", "process/lost_process"),
            )
        ),
        *(f"drivers/{name}.py" for name in ("rmcu/_driver", "dyno/_driver", "dyno/_node", "panel/_panel")),
        "drivers/bus_health.py",
    ),
}
#: Seconds of tests tried at first, and on those that the first do not notice.
_AT_FIRST_S, _AT_LAST_S = 2.0, 30.0


def main(arguments: Sequence[str] | None = None) -> int:
    """Copy the repository, try mutants there, write the page and, beside it, the same as JSON."""
    options = _options(arguments)
    if options.in_copy:
        return _in_copy(options)
    with tempfile.TemporaryDirectory(prefix="mutants-") as place:
        copy = Path(place).resolve() / "copy"
        _copy(Path.cwd(), copy)
        given = [*(sys.argv[1:] if arguments is None else arguments)]
        few = {f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "NUMBA")}
        done = subprocess.run(
            [sys.executable, "-m", "tests.mutants", *given, "--in-copy"],
            cwd=copy,
            env=os.environ | few | {"PYTHONPATH": str(copy)},
            check=False,
        )
        found = copy / ".mutants-results.json"
        if not found.is_file():
            return done.returncode or 1
        results = _results(found)
    _write(results, options)
    return done.returncode


def _write(results: list[Tried], options: argparse.Namespace) -> None:
    data_file = options.out.with_suffix(".json")
    if data_file.is_file():  # packages that were not asked for stay
        before = _results(data_file)
        new = {one.package for one in results}
        results = [one for one in before if one.package not in new] + results
    results.sort(key=lambda one: [*TESTS].index(one.package))
    page = as_markdown(results, explained())
    options.out.write_text(page, encoding="utf-8")
    data_file.write_text(json.dumps([asdict(one) for one in results], indent=1) + "\n", encoding="utf-8")
    print(page)


def explained() -> dict[tuple[str, str, str], str]:
    """Why a fault that no test notices is none, or harms no one: by file, code, code with the fault."""
    table = tomllib.loads(_EXPLAINED.read_text("utf-8"))
    return {(file, one["code"], one["fault"]): one["why"] for file, ones in table.items() for one in ones}


def _copy(source: Path, target: Path) -> None:
    """What the repository holds, with changes that are not committed yet, and what numba has compiled of it.

    Compiled anew it would count as seconds of the first test that needs it, which then is not tried.
    """
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=source,
        capture_output=True,
        check=True,
    )
    files = [Path(name) for name in listed.stdout.decode().split("\0") if name]
    folders = {file.parent / "__pycache__" for file in files}
    compiled = [file.relative_to(source) for folder in folders for file in (source / folder).glob("*.nb[ic]")]
    for file in (*files, *compiled):
        if (source / file).is_file():
            (target / file).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(source / file, target / file)


def _in_copy(options: argparse.Namespace) -> int:
    root = Path.cwd()
    import_heavy_libraries()
    results = [_tried(root, package, options) for package in options.package or TESTS]
    text = json.dumps([asdict(one) for one in results])
    (root / ".mutants-results.json").write_text(text, encoding="utf-8")
    return 0


def _tried(root: Path, package: str, options: argparse.Namespace) -> Tried:
    start = time.perf_counter()
    files = _files(root, package)
    coverage = covered(root, _sources(package), options.tests or TESTS[package])
    before = _before(options, package)
    mutants, total = drawn(files, root, 0 if before else options.count, options.seed)
    if before:
        mutants = not_noticed_before(before.outcomes, root)
    trial = Trial(root)
    all_tests = sorted(coverage.seconds, key=lambda test: coverage.seconds[test])
    quick = _within(all_tests, coverage.seconds, _AT_LAST_S)
    trial.check(quick, sum(coverage.seconds[test] for test in quick))
    prepared = time.perf_counter()
    print(
        f"{package}: {len(coverage.seconds)} tests in {prepared - start:.0f} s", file=sys.stderr, flush=True
    )
    outcomes: list[Outcome] = []
    for number, mutant in enumerate(mutants, 1):
        if outcomes and time.perf_counter() - prepared > 60.0 * options.minutes:
            break
        outcomes.append(_outcome(trial, root, coverage, mutant))
        _tell(number, len(mutants), outcomes[-1])
    seconds = (time.perf_counter() - prepared) / max(len(outcomes), 1)
    if before:
        new = {one.fault: one for one in outcomes}
        return replace(before, outcomes=[new.get(one.fault, one) for one in before.outcomes])
    return Tried(package, options.seed, total, len(coverage.seconds), round(seconds, 2), outcomes)


def _before(options: argparse.Namespace, package: str) -> Tried | None:
    """What came of it earlier, if only what was not noticed then is to be tried."""
    if options.again is None:
        return None
    return next((one for one in _results(options.again) if one.package == package), None)


def _files(root: Path, package: str) -> list[Path]:
    if package in FILES:
        return [root / name for name in FILES[package]]
    return sorted((root / package.replace(".", "/")).rglob("*.py"))


def _sources(package: str) -> list[str]:
    """Where coverage looks: folders."""
    if package in FILES:
        return sorted({str(Path(name).parent) for name in FILES[package]})
    return [package.replace(".", "/")]


def _outcome(trial: Trial, root: Path, coverage: Coverage, mutant: Mutant) -> Outcome:
    source = (root / mutant.file).read_text("utf-8")
    mutated = mutant.code(source)
    tests = coverage.tests_for(mutant.file, shown_by(source, mutant.line))
    before, after = difference(source, mutated)
    noticed = "" if tests else "not run"
    at = 0
    for limit in (_AT_FIRST_S, _AT_LAST_S):
        chosen = _within(tests[at:], coverage.seconds, limit)
        if noticed or not chosen:
            break
        expected = sum(coverage.seconds[test] for test in chosen)
        noticed = trial.notices(mutant.file, mutated, chosen, expected)
        at += len(chosen)
    name = mutant.operator.removeprefix("core/")
    return Outcome(mutant.file, mutant.line, name, before, after, noticed, at)


def _within(tests: Sequence[str], seconds: dict[str, float], limit: float) -> list[str]:
    """The first tests that take `limit` s together, one at least."""
    chosen: list[str] = []
    total = 0.0
    for test in tests:
        total += seconds[test]
        if chosen and total > limit:
            break
        chosen.append(test)
    return chosen


def _tell(number: int, total: int, one: Outcome) -> None:
    said = one.noticed or "NOT NOTICED"
    print(f"[{number}/{total}] {said} {one.file}:{one.line} {one.after}", file=sys.stderr, flush=True)


def _results(path: Path) -> list[Tried]:
    return [_read(one) for one in json.loads(path.read_text("utf-8"))]


def _read(data: dict[str, Any]) -> Tried:
    outcomes = [Outcome(**one) for one in data.pop("outcomes")]
    return Tried(**data, outcomes=outcomes)


def _options(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.mutants", description=__doc__)
    parser.add_argument("--package", action="append", choices=TESTS, help="only this one; may be repeated")
    parser.add_argument("--count", type=int, default=300, help="mutants of each package")
    parser.add_argument("--seed", type=int, default=1, help="another seed, other mutants")
    parser.add_argument(
        "--minutes", type=float, default=float("inf"), help="try no more of a package after so long"
    )
    parser.add_argument(
        "--again", type=lambda given: Path(given).resolve(), help="JSON of a run: only what it did not notice"
    )
    parser.add_argument("--tests", action="append", help="run these tests instead; may be repeated")
    parser.add_argument("--out", type=Path, default=_RESULTS, help="Markdown to write; a JSON goes beside it")
    parser.add_argument("--in-copy", action="store_true", help=argparse.SUPPRESS)
    return parser.parse_args(arguments)
