"""What a run gave a test: verdicts, files, and what is wrong with it in words."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hil.core.recording import Recording
    from hil.core.result import CriterionResult, RunResult


@dataclass(frozen=True)
class Ran:
    """A run that has ended: what was judged, and where its recording and reports are.

    `trouble` is what the command printed if the bench failed.
    """

    result: RunResult
    folder: Path
    trouble: str = ""

    def __getitem__(self, criterion: str) -> CriterionResult:
        """A criterion by its id: its value, limits and verdict; KeyError names those there are."""
        for one in self.result.criteria:
            if one.id == criterion:
                return one
        raise KeyError(f"{criterion}: there are {', '.join(one.id for one in self.result.criteria)}")

    @cached_property
    def recording(self) -> Recording:
        """What was measured."""
        from hil.core.recording import read_recording

        return read_recording(self.folder / self.result.files["recording"])

    def check(self) -> None:
        """Assert that the run came to its end, left the bench safe and kept every limit.

        Raises:
            AssertionError: all that is wrong, with values and limits.
        """
        __tracebackhide__ = True
        wrong = [*_wrong_with(self), *(in_words(one) for one in self.result.criteria if is_bad(one))]
        if wrong or self.result.verdict not in ("pass", "done"):
            raise AssertionError("\n".join([*(wrong or [self.result.verdict]), f"in {self.folder}"]))


def troubles(ran: Ran) -> Iterator[tuple[str, str]]:
    """What is wrong with the run itself: 'run' or 'safe_state', and words."""
    if ran.trouble or ran.result.reason:
        yield "run", ran.trouble or ran.result.reason
    if ran.result.safe_state == "not_confirmed":
        yield "safe_state", "the bench did not confirm its safe state after the run: treat it as live"


def _wrong_with(ran: Ran) -> list[str]:
    return [text for _, text in troubles(ran)]


def is_bad(criterion: CriterionResult) -> bool:
    return criterion.failed or criterion.verdict in ("error", "not_judged")


def in_words(criterion: CriterionResult) -> str:
    """A criterion with its value and limits, on a line."""
    from reports import labels
    from reports.criteria import in_words as criterion_in_words

    if criterion.verdict == "informational":
        return f"{criterion.id}: informational: {labels.quantity(criterion.value, criterion.unit)}"
    return f"{criterion.id}: {criterion.verdict.replace('_', ' ')}: {criterion_in_words(criterion)}"


def properties(ran: Ran, *criteria: CriterionResult) -> list[tuple[str, object]]:
    """For JUnit: the run's files, and what was found and allowed."""
    found: list[tuple[str, object]] = [("bench", ran.result.bench), ("folder", str(ran.folder))]
    for one in criteria:
        figures = {"value": one.value, "lower": one.lower, "upper": one.upper, "margin": one.margin}
        found += [(f"{one.id}.{key}", repr(value)) for key, value in figures.items() if value is not None]
        found += [(f"{one.id}.unit", one.unit), (f"{one.id}.verdict", one.verdict)]
    return found
