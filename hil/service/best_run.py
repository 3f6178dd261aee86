"""The run that others are compared with: of those that passed the same criteria, the farthest from limits."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from hil.core.result import CriterionResult
from test_plans import CHECKS

_RELATIVE = ".below."  # in the id of a criterion whose limit is another segment's value of the same run


@dataclass(frozen=True)
class BestRun:
    """A run with its smallest margin, as a share of the limit, and the criterion that has it."""

    run: int
    margin: float
    criterion: str


@dataclass(frozen=True)
class Setting:
    """What a run was given: its plan, its bench, and values of all variables of the plan."""

    plan: str
    bench: str
    values: Mapping[str, float]

    def nearness_to(self, other: Setting) -> int:
        """How much of it is the same: the plan and the values count more than the bench."""
        same_plan, same_values = self.plan == other.plan, self.values == other.values
        return 2 * same_plan + 2 * same_values + (self.bench == other.bench)


def best_run(
    wanted: Sequence[CriterionResult],
    passed: Mapping[int, Sequence[CriterionResult]],
    nearness: Callable[[int], int] = lambda run: 0,
) -> tuple[BestRun | None, int]:
    """The best of the runs that were judged by the same criteria as a run, and among how many it is that.

    `wanted` are the criteria of that run, `passed` those of runs that passed, by number. Which plan a run is
    of does not count, so that copies do: runs with the same limits on the same criteria of their plans are of
    one kind. Checks of any device do not count, and a limit of zero has no margin. Of equals the newest
    is best. Only those of the greatest `nearness` that there is, by their numbers, are looked at.
    """
    demands = _demands(wanted)
    alike = {
        number: margins[0]
        for number, ones in passed.items()
        if demands and _demands(ones) == demands and (margins := _margins(ones))
    }
    nearest = max(map(nearness, alike), default=0)
    near = [BestRun(number, *found) for number, found in alike.items() if nearness(number) == nearest]
    return max(near, key=lambda one: (one.margin, one.run), default=None), len(near)


def _of_plan(criteria: Sequence[CriterionResult]) -> list[CriterionResult]:
    return [one for one in criteria if one.id.rpartition(".")[2] not in CHECKS]


def _demands(criteria: Sequence[CriterionResult]) -> frozenset[tuple[str, str, float | None, float | None]]:
    """What is demanded, without values; a relative limit is a value, and does not count."""
    return frozenset(
        (one.id, one.unit, None, None) if _RELATIVE in one.id else (one.id, one.unit, one.upper, one.lower)
        for one in _of_plan(criteria)
        if one.has_limit or _RELATIVE in one.id
    )


def _margins(criteria: Sequence[CriterionResult]) -> list[tuple[float, str]]:
    """Margins with their criteria, the smallest first."""
    return sorted((one.margin, one.id) for one in _of_plan(criteria) if one.margin is not None)
