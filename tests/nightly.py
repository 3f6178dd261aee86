"""`python -m tests.nightly [PART…]`: what does not gate a change, part by part; the figures go into docs.

Each part runs alone: slow tests of some folders, or a long set with a command and a page of its own. When a
part ends, its row in docs/reference/nightly.md gets date, commit, minutes and what its tests said (from the
XML file that pytest writes). A part that fails leaves its row too, and exit code 1. The two parts of the gate
are there for its figures: they run where they are asked for.
"""

from __future__ import annotations

import argparse
import datetime
import re
import signal
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs/reference/nightly.md"
_WORKERS = ("-n", "2", "--dist", "worksteal", "--timeout", "7200")
NOTHING_RAN = 5  # pytest's exit code


@dataclass(frozen=True)
class Part:
    """What a part proves, and how: tests below `places` that carry `mark`, or else the module `command`."""

    proves: str
    places: tuple[str, ...] = ()
    mark: str = "nightly"
    command: tuple[str, ...] = ()

    def arguments(self, junit: Path) -> list[str]:
        """What stands behind `python -m`."""
        if self.command:
            return list(self.command)
        return ["pytest", "-m", self.mark, *_WORKERS, f"--junitxml={junit}", *self.places]


PARTS: dict[str, Part] = {
    "gate-quick": Part("what `make test` proves", ("tests",), "not slow and not hunt"),
    "gate-slow": Part("what `make test-slow` proves", ("tests",), "slow and not nightly"),
    "analysis": Part(
        "identification, design, tuning and target search in depth",
        (
            "tests/hil/analysis",
            "--ignore=tests/hil/analysis/diagnosis",
        ),
    ),
    "diagnosis": Part(
        "every kind of hidden effect, on the wire and from bad data", ("tests/hil/analysis/diagnosis",)
    ),
    "commands": Part(
        "every command as a person uses it, what the documentation shows, the plugin, the notebook",
        (
            "tests/hil/cli",
            "tests/docs",
            "tests/bad_inputs",
            "tests/hil/test_notebook.py",
            "tests/hil/test_pytest_plugin.py",
            "tests/hil/test_pytest_plugin_ends.py",
            "tests/hil/test_base_install.py",
            "tests/hil/campaign",
            "tests/reports",
        ),
    ),
    "engine": Part(
        "the bench in real time, forecasts, physics, single faults, tools of others on each wire",
        (
            "tests/hil/app",
            "tests/hil/engine",
            "tests/hil/core",
            "tests/hil/plant",
            "tests/hil/fmu",
            "tests/transports",
            "tests/drivers",
            "tests/sim_backend",
            "tests/test_plans",
            "tests/formats",
            "tests/benchmarks",
            "tests/test_wheel.py",
            "tests/faults",
            "tests/test_imports.py",
            "tests/wrong_controllers",
        ),
    ),
    "service": Part(
        "page, studies, campaigns, archive, agents and stores of the service",
        ("tests/hil/service", "tests/hil/execution", "--ignore=tests/hil/service/test_api_fuzz.py"),
    ),
    "api": Part(
        "every operation of the API, with requests made from its document",
        ("tests/hil/service/test_api_fuzz.py",),
    ),
    "processes": Part(
        "processes of a run killed and frozen; faults put into the code",
        ("tests/process_faults", "tests/mutants"),
    ),
    "readers": Part(
        "readers of other people on every file that is written", ("tests/readers", "tests/file_kinds")
    ),
    "fuzz": Part("damaged inputs at every parser", ("tests/fuzz",)),
    "blind-slow": Part("the fixed part of the blind diagnosis set, and its scoring", ("tests/blind",)),
    "hunt": Part("hundreds of further cases of all the sets", ("tests",), "hunt"),
    "can-vm": Part(
        "a minute of frames at the limit of an emulated machine",
        command=("tests.can_vm", "tests/can_vm/test_at_the_limit.py"),
    ),
    "bad-inputs": Part(
        "bad input on every command: [page](bad-inputs.md)", command=("tests.bad_inputs", "--write")
    ),
    "fault-matrix": Part(
        "every fault in every phase: [page](faults.md)", command=("tests.faults", "--write")
    ),
    "process-faults": Part(
        "each process in every phase: [page](process-faults.md)", command=("tests.process_faults", "--write")
    ),
    "wrong-controllers": Part(
        "all wrong controllers: [page](wrong-controllers.md)", command=("tests.wrong_controllers", "--write")
    ),
    "blind": Part("the whole blind diagnosis set: [page](blind-results.md)", command=("tests.blind",)),
}
_ROW = re.compile(r"^\| `(?P<part>[\w-]+)` \|.*$", re.MULTILINE)


def main() -> int:
    """Run the parts that are asked for, or all of them."""
    parser = argparse.ArgumentParser(prog="python -m tests.nightly")
    parser.add_argument(
        "parts", nargs="*", metavar="PART", help=f"of {', '.join(PARTS)}; without: all of the night"
    )
    asked = parser.parse_args().parts or [part for part in PARTS if not part.startswith("gate-")]
    unknown = [part for part in asked if part not in PARTS]
    if unknown:
        parser.error(f"no part {', '.join(unknown)}; there are {', '.join(PARTS)}")
    _take_signals()
    return max([_run(part) for part in asked])


def _take_signals() -> None:
    """Signals that `nohup` or a shell's `&` left ignored would be ignored by every run that is tested."""
    for number in (signal.SIGHUP, signal.SIGQUIT):
        signal.signal(number, signal.SIG_DFL)
    signal.signal(signal.SIGINT, signal.default_int_handler)


def _run(name: str) -> int:
    """Run one part and write its row."""
    print(f"== {name}: {PARTS[name].proves}", flush=True)
    commit, started_s = _commit(), time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        junit = Path(folder, "junit.xml")
        done = subprocess.run([sys.executable, "-m", *PARTS[name].arguments(junit)], cwd=ROOT, check=False)
        said = counted(junit) if junit.exists() else f"exit code {done.returncode}"
    minutes = (time.monotonic() - started_s) / 60
    text = with_row(PAGE.read_text("utf-8"), name, [_today(), commit, f"{minutes:.1f}", said])
    PAGE.write_text(text, "utf-8")
    return 0 if done.returncode in (0, NOTHING_RAN) else 1


def counted(junit: Path) -> str:
    """What the tests of one XML file of pytest's said, in words."""
    suites = ElementTree.parse(junit).getroot().iter("testsuite")
    totals = dict.fromkeys(("tests", "failures", "errors", "skipped"), 0)
    for suite in suites:
        for key in totals:
            totals[key] += int(suite.get(key, "0"))
    passed = totals["tests"] - totals["failures"] - totals["errors"] - totals["skipped"]
    others = [
        f"{totals[key]} {word}"
        for key, word in (("failures", "failed"), ("errors", "with errors"), ("skipped", "skipped"))
        if totals[key]
    ]
    return ", ".join([f"{passed} passed", *others])


def with_row(page: str, name: str, figures: list[str]) -> str:
    """The page with the row of a part written anew; every other row stays as it is."""
    row = f"| `{name}` | {PARTS[name].proves} | {' | '.join(figures)} |"
    return _ROW.sub(lambda found: row if found["part"] == name else found[0], page)


def _today() -> str:
    return f"{datetime.datetime.now(datetime.UTC):%Y-%m-%d}"


def _commit() -> str:
    """The commit that is tested, with a + where the tree differs from it."""

    def said(*arguments: str) -> str:
        done = subprocess.run(("git", *arguments), cwd=ROOT, capture_output=True, text=True, check=False)
        return done.stdout.strip()

    changed = said("status", "--porcelain", "--untracked-files=no", "--", ".", ":!docs")
    return (said("rev-parse", "--short", "HEAD") or "?") + ("+" if changed else "")


if __name__ == "__main__":
    sys.exit(main())
