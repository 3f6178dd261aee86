"""What was predicted beside what a run measured."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from hil.core.result import CriterionResult


@dataclass(frozen=True)
class Agreement:
    """One criterion, predicted and measured.

    `apart` is the distance as a share of the limit where there is one, else of what was predicted; None where
    one of them has no value.
    """

    id: str
    unit: str
    predicted: CriterionResult
    measured: CriterionResult
    apart: float | None


@dataclass(frozen=True)
class Confirmation:
    """All criteria that depend on the controller, in the plan's order; `allowed` is the largest distance."""

    criteria: tuple[Agreement, ...]
    allowed: float

    @property
    def beyond(self) -> tuple[Agreement, ...]:
        """Criteria that differ by more than is allowed, or have a value on one side only."""
        return tuple(one for one in self.criteria if one.apart is None or one.apart > self.allowed)

    @property
    def agrees(self) -> bool:
        """Whether none is."""
        return not self.beyond

    @property
    def passed(self) -> bool:
        """Whether none of them failed in the run."""
        return all(one.measured.verdict == "pass" for one in self.criteria)


def confirmation(
    predicted: Iterable[CriterionResult], measured: Iterable[CriterionResult], allowed: float
) -> Confirmation:
    """Put the two side by side; what was predicted decides which criteria."""
    known = {criterion.id: criterion for criterion in measured}
    pairs = [(one, known[one.id]) for one in predicted if one.id in known]
    return Confirmation(
        tuple(Agreement(one.id, one.unit, one, other, _apart(one, other)) for one, other in pairs), allowed
    )


def _apart(predicted: CriterionResult, measured: CriterionResult) -> float | None:
    if predicted.value is None or measured.value is None:
        return None
    limit = predicted.upper if predicted.upper is not None else predicted.lower
    size = abs(predicted.value if limit is None else limit)
    return abs(measured.value - predicted.value) / max(size, 1e-12)
