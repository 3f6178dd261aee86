"""Results of mutants as Markdown: score, interval, and what the tests did not notice."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

_HEAD = """# What the tests notice

`make mutants` puts small faults into the code, one at a time, and runs the tests that run the changed line.
A fault that no test notices is a gap in the tests, or no fault at all (an equivalent mutant: the code does
the same with it). Score: share of the faults that were noticed, with the 95 % interval of the share among
all possible ones (Wilson). Each place in the code is drawn once before any place is drawn a second time.

The faults are cosmic-ray's (comparison, arithmetic, boolean, number, exception, decorator, loop). Its own
runner starts a process for each, which imports numpy, scipy and numba anew: over 6 s before the first test.
mutmut 3 changes only what is inside functions and wraps them, so that limits in class bodies and module
constants are left out and numba does not compile what is wrapped. `tests/mutants` therefore forks a process
that has imported the heavy libraries, and runs only the tests that cover the line (pytest-cov's contexts),
the quickest first, until one fails: up to 2 s of tests, then 30 s for what these did not notice. Functions
that numba compiles are left out: closed forms and other integrators hold them. Annotations, which nothing
evaluates, are not changed. Tests named after the changed file go first, and those of a function's body count
as those of its head.

What fails is run once more without the fault: a test in real time also trips because the machine is busy,
and then tells nothing. Tests have a minute and four times as long as they took without a fault; who is not
done by then counts as having noticed, and is in the table.

`safety` are the files of limits, interlocks and holds, of the emergency stop, of the way to the safe state,
of the process that holds the hardware and the one that watches it, and the drivers of RMCU, dynos and panel.
"""


@dataclass(frozen=True)
class Outcome:
    """A mutant: `noticed` as failed, timeout, crashed; `not run`: no test runs the line; empty: it passed."""

    file: str
    line: int
    operator: str
    before: str
    after: str
    noticed: str
    tests: int

    @property
    def fault(self) -> tuple[str, str, str]:
        """What it is, wherever its line has moved to."""
        return self.file, self.before, self.after

    @property
    def survived(self) -> bool:
        return self.noticed in ("", "not run")


@dataclass(frozen=True)
class Tried:
    """A package: `total` mutants there are, `tests` tests in all, seconds for one mutant."""

    package: str
    seed: int
    total: int
    tests: int
    seconds: float
    outcomes: list[Outcome]

    @property
    def noticed(self) -> int:
        return sum(not one.survived for one in self.outcomes)

    @property
    def timed_out(self) -> int:
        """Those of the noticed whose tests took too long."""
        return sum(one.noticed == "timeout" for one in self.outcomes)


def wilson(successes: int, trials: int, z: float = 1.96) -> tuple[float, float]:
    """The 95 % interval of a share (Wilson, J. Am. Stat. Assoc. 22, 1927)."""
    if trials == 0:
        return 0.0, 1.0
    share = successes / trials
    middle = share + z * z / (2 * trials)
    half = z * math.sqrt(share * (1 - share) / trials + z * z / (4 * trials * trials))
    scale = 1 + z * z / trials
    return max(0.0, (middle - half) / scale), min(1.0, (middle + half) / scale)


def as_markdown(results: Sequence[Tried], why: Mapping[tuple[str, str, str], str]) -> str:
    """The whole page; `why` a fault that no test notices is none, or harms no one: by file, code, fault."""
    head = "package", "mutants tried", "there are", "noticed", "timed out", "score, %", "95 % interval"
    lines = [f"| {' | '.join((*head, 's each', 'seed'))} |", "| --- " * 9 + "|"]
    for one in results:
        tried = len(one.outcomes)
        low, high = wilson(one.noticed, tried)
        score = 100 * one.noticed / max(tried, 1)
        lines.append(
            f"| {one.package} | {tried} | {one.total} | {one.noticed} | {one.timed_out} | {score:.1f} "
            f"| {100 * low:.1f} to {100 * high:.1f} | {one.seconds:.1f} | {one.seed} |"
        )
    parts = [_HEAD, "\n".join(lines), "## Not noticed"]
    parts += [_survivors(one, why) for one in results]
    return "\n\n".join(part.strip() for part in parts) + "\n"


def _survivors(tried: Tried, why: Mapping[tuple[str, str, str], str]) -> str:
    survivors = sorted((o for o in tried.outcomes if o.survived), key=lambda o: (o.file, o.line, o.after))
    if not survivors:
        return f"### {tried.package}\n\nNone."
    rows = [
        [f"{one.file}:{one.line}", _cell(one.before), _cell(one.after), one.noticed or "passed"]
        for one in survivors
    ]
    head = ["where", "code", "with the fault", "tests"]
    if any(one.fault in why for one in survivors):
        head.append("read")
        rows = [[*row, why.get(one.fault, "")] for row, one in zip(rows, survivors, strict=True)]
    lines = [f"### {tried.package}\n", f"| {' | '.join(head)} |", "| --- " * len(head) + "|"]
    return "\n".join([*lines, *(f"| {' | '.join(row)} |" for row in rows)])


def _cell(code: str) -> str:
    escaped = code.replace("|", "\\|")
    return f"`{escaped}`" if escaped else ""
