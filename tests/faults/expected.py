"""What a row of the table of faults says: what is injected, in which phases, what a run has to make of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from tests.faults.stage import PHASES, Injection

ALL = tuple(PHASES)
LIVE = ("pre-flight", "arming", "holding speed", "stepping", "prompting", "analysing", "ramping down")
ARMED = LIVE[1:]
PASSED, BENCH, INTERRUPTED = 0, 3, 130
#: Torque has to be gone within this time of an injection that ends a run, s: silence is noticed after 0.1 s.
NOTICED_S = 0.15


@dataclass(frozen=True)
class Expected:
    """What is right: exit code, safe state, and words that the message must have (a regular expression)."""

    code: int = BENCH
    says: str = ""
    safe: tuple[str, ...] = ("confirmed",)


@dataclass(frozen=True)
class FaultRow:
    """One fault. `within_s`: how soon torque is gone; None: the run goes on, it is gone at its end."""

    id: str
    title: str
    make: Callable[[], Injection]
    expected: Expected
    phases: tuple[str, ...] = LIVE
    within_s: float | None = NOTICED_S
    other: Mapping[str, Expected] = field(default_factory=dict)
    device: bool = False  # whether the oil unit is there
    beside: str = ""  # "panel", "patient panel", "ram": what else stands beside the bench
    ponder: str = "well"

    def expects(self, phase: str) -> Expected:
        return self.other.get(phase, self.expected)


def row(id_: str, title: str, make: Callable[[], Injection], says: str = "", **keys: object) -> FaultRow:
    """A row; keys of `Expected` and of `FaultRow`."""
    own = {key: keys.pop(key) for key in ("code", "safe") if key in keys}
    return FaultRow(id_, title, make, Expected(says=says, **own), **keys)  # type: ignore[arg-type]


EITHER = ("confirmed", "not_confirmed")
UNSAFE = ("not_confirmed",)
GOES_ON = Expected(PASSED)
