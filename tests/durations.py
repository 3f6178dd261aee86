"""`python -m tests.durations [PYTEST'S ARGUMENTS]`: measures what tests take, for tests/gate.py.

Carries the tests out (without arguments those of the gate) and writes the seconds of each that is slow into
`durations.json`; tests that were not executed keep theirs. Preparing what a module shares counts for the
module, not for the test that happens to be the first.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

from tests.gate import DURATIONS, QUICK_S

_ARGUMENTS = ("-n", "2", "--dist", "worksteal", "-m", "not nightly and not hunt", "--timeout", "7200")


class Stopwatch:
    """Seconds of preparing and of executing, by test."""

    def __init__(self) -> None:
        self.prepared_s: dict[str, float] = {}
        self.took_s: dict[str, float] = {}
        self.marked: set[str] = set()

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Called of each phase of each test; with xdist in the process that has the workers."""
        if report.when == "setup":
            self.prepared_s[report.nodeid] = report.duration
        elif report.when == "call":
            self.took_s[report.nodeid] = report.duration
        if "slow" in report.keywords:
            self.marked.add(report.nodeid)

    def written_to(self, file: Path) -> None:
        """Write the file anew: what was executed now, and what is there still of before."""
        kept = json.loads(file.read_text("utf-8")) if file.exists() else {}
        modules = {nodeid.partition("::")[0] for nodeid in self.took_s}
        kept = {key: value for key, value in kept.items() if key not in self.took_s and key not in modules}
        for module in modules:
            most = max(s for nodeid, s in self.prepared_s.items() if nodeid.startswith(f"{module}::"))
            if most > QUICK_S:
                kept[module] = round(most, 2)
        kept |= {
            nodeid: round(s, 2) for nodeid, s in self.took_s.items() if s > QUICK_S or nodeid in self.marked
        }
        file.write_text(json.dumps(dict(sorted(kept.items())), indent=0, ensure_ascii=False) + "\n", "utf-8")


def main() -> int:
    """Measure; pytest's exit code."""
    watch = Stopwatch()
    code = pytest.main(sys.argv[1:] or list(_ARGUMENTS), plugins=[watch])
    watch.written_to(DURATIONS)
    return int(code)


if __name__ == "__main__":
    sys.exit(main())
