"""Which tests run a line, and how long they take: one run of the tests under coverage."""

from __future__ import annotations

import ast
import json
import os
import subprocess
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from coverage import CoverageData

QUICK = "not slow and not hunt"
_LONG_S = 1.0


@dataclass(frozen=True)
class Coverage:
    """`by_line[file][line]`: tests that run it; `by_file[file]`: tests that run anything of it."""

    by_line: dict[str, dict[int, set[str]]]
    by_file: dict[str, set[str]]
    seconds: dict[str, float]

    def tests_for(self, file: str, lines: Iterable[int]) -> list[str]:
        """Those named after the file or its folder first, and the quickest first; what takes long is last.

        For lines that only importing runs, those that run any line of the file, those named after it and
        those of its folder: what a library or another process makes of it is seen as no line that runs.
        """
        own = self.by_line.get(file, {})
        tests = set[str]().union(*(own.get(line, set()) for line in lines))
        named = self._named(file)
        tests = tests or self.by_file.get(file, set()) | named | self._beside(file)
        return sorted(
            tests,
            key=lambda test: (self.seconds[test] > _LONG_S, test not in named, self.seconds[test], test),
        )

    def _named(self, file: str) -> set[str]:
        path = Path(file)
        own = [f"/test_{name}.py::" for name in (path.stem.removeprefix("_"), path.parent.name)]
        return {test for test in self.seconds if any(name in test for name in own)}

    def _beside(self, file: str) -> set[str]:
        folder = Path("tests") / Path(file).parent
        return {test for test in self.seconds if Path(test.partition("::")[0]).parent == folder}


def shown_by(source: str, line: int) -> range:
    """Lines that run if what stands in `line` does: itself, or of a function's head its body."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            head = min(part.lineno for part in (node, *node.decorator_list))
            if head <= line < node.body[0].lineno:
                return range(node.body[0].lineno, (node.end_lineno or line) + 1)
    return range(line, line + 1)


class Times:
    """A pytest plugin: seconds of each test that passed, as JSON."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._seconds: dict[str, float] = {}
        self._failed: set[str] = set()

    def pytest_runtest_logreport(self, report: object) -> None:
        name, seconds = report.nodeid, report.duration  # type: ignore[attr-defined]
        self._seconds[name] = self._seconds.get(name, 0.0) + seconds
        if report.outcome != "passed":  # type: ignore[attr-defined]
            self._failed.add(name)

    def pytest_sessionfinish(self) -> None:
        passed = {name: s for name, s in self._seconds.items() if name not in self._failed}
        self._path.write_text(json.dumps(passed), encoding="utf-8")


def covered(root: Path, sources: Sequence[str], tests: Sequence[str]) -> Coverage:
    """Run the quick ones of `tests` in `root` and read what they cover of the folders `sources`.

    Raises:
        RuntimeError: the tests could not be run.
    """
    data_file, times_file = root / ".mutants-coverage", root / ".mutants-times.json"
    program = (
        "import sys, pytest; from pathlib import Path; from tests.mutants.covering import Times; "
        "sys.exit(pytest.main(sys.argv[2:], plugins=[Times(Path(sys.argv[1]))]))"
    )
    arguments = [
        str(times_file),
        "-q",
        "-p",
        "no:cacheprovider",
        "-m",
        QUICK,
        *(f"--cov={folder}" for folder in sources),
    ]
    arguments += ["--cov-context=test", "--cov-report=", "--cov-config=/dev/null", *tests]
    done = subprocess.run(
        [sys.executable, "-c", program, *arguments],
        cwd=root,
        env=_environment(data_file),
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode not in (0, 1) or not times_file.is_file():
        raise RuntimeError(
            f"the tests of {' '.join(sources)} cannot be run:\n{done.stdout[-2000:]}{done.stderr[-2000:]}"
        )
    seconds: dict[str, float] = json.loads(times_file.read_text("utf-8"))
    return _read(data_file, root, seconds)


def _environment(data_file: Path) -> dict[str, str]:
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    return kept | {"COVERAGE_FILE": str(data_file)}  # what it compiles is read for every mutant


def _read(data_file: Path, root: Path, seconds: dict[str, float]) -> Coverage:
    data = CoverageData(str(data_file))
    data.read()
    by_line: dict[str, dict[int, set[str]]] = {}
    by_file: dict[str, set[str]] = {}
    for name in data.measured_files():
        file = Path(name).relative_to(root).as_posix()
        lines = by_line[file] = {}
        by_file[file] = set()
        for line, contexts in data.contexts_by_lineno(name).items():
            tests = {context.rpartition("|")[0] for context in contexts} & seconds.keys()
            if tests:
                lines[line] = tests
                by_file[file] |= tests
    return Coverage(by_line, by_file, seconds)
