"""What was predicted beside what a run measured."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from hil.core.result import CriterionResult


@dataclass(frozen=True)
class Agreement:
    """One criterion, predicted and measured.

    `difference` is measured less predicted, in the criterion's unit; `apart` its size as a share of the
    limit, of the larger of both values where there is none or it is zero. None where one has no value.
    """

    id: str
    unit: str
    predicted: CriterionResult
    measured: CriterionResult
    apart: float | None

    @property
    def difference(self) -> float | None:
        """By how much more was measured than predicted, in `unit`."""
        if self.predicted.value is None or self.measured.value is None:
            return None
        return self.measured.value - self.predicted.value

    @property
    def of_limit(self) -> bool:
        """Whether `apart` is a share of a limit."""
        return bool(_limit(self.predicted))


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
    difference = abs(measured.value - predicted.value)
    size = abs(_limit(predicted)) or max(abs(measured.value), abs(predicted.value))
    return difference / size if difference else 0.0


def _limit(criterion: CriterionResult) -> float:
    """The limit that counts, 0 without one."""
    return (criterion.upper if criterion.upper is not None else criterion.lower) or 0.0
