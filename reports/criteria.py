"""The criteria of a run as rows of a table, and the definitions that they share."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import get_args

from hil.core.result import CriterionResult, CriterionVerdict, RunResult, Segment
from reports import labels
from reports.members import controller_of

_USUAL_DECIMALS, _MOST_DECIMALS = 4, 9


_AS_ABOVE = "for the same reason"


@dataclass(frozen=True)
class CriterionRow:
    """One criterion, formatted; `definition` is the number of its definition, 0 without one."""

    id: str
    title: str
    value: str
    unit: str
    limit: str
    margin: str
    verdict: str
    unmet: bool
    reason: str
    unmet_because: str
    definition: int


@dataclass(frozen=True)
class CriterionGroup:
    """The criteria of one segment, or those that belong to none."""

    title: str
    rows: tuple[CriterionRow, ...]


@dataclass(frozen=True)
class CriteriaTable:
    """All criteria in the plan's order, and their definitions numbered from 1."""

    groups: tuple[CriterionGroup, ...]
    definitions: tuple[str, ...]


def criteria_table(result: RunResult) -> CriteriaTable:
    """Rows by segment: the part of a criterion's id before the dot."""
    definitions = list(dict.fromkeys(c.definition for c in result.criteria if c.definition))
    segments = {segment.id: segment for segment in result.segments}
    grouped: dict[str, list[CriterionRow]] = {}
    known: set[str] = set()  # a sensor that fails five criteria is reported once
    for criterion in result.criteria:
        title = _group_title(criterion, segments)
        number = definitions.index(criterion.definition) + 1 if criterion.definition else 0
        grouped.setdefault(title, []).append(_row(criterion, number, known))
        known.update({criterion.reason} - {""})
    groups = tuple(CriterionGroup(title, tuple(rows)) for title, rows in grouped.items())
    return CriteriaTable(groups, tuple(definitions))


def count_by_verdict(criteria: Iterable[CriterionResult]) -> dict[str, int]:
    """How many have each verdict."""
    counts = dict.fromkeys(get_args(CriterionVerdict), 0)
    for criterion in criteria:
        counts[criterion.verdict] += 1
    return counts


def in_words(criterion: CriterionResult) -> str:
    """One line: what was found against what was allowed; for messages."""
    if criterion.value is None and criterion.reason:
        return criterion.reason
    value = labels.quantity(criterion.value, criterion.unit, _decimals(criterion))
    limit = _limit(criterion)
    text = f"{value}, allowed is {limit}{labels.THIN}{labels.unit(criterion.unit)}".rstrip()
    return f"{text}; {criterion.reason}" if criterion.reason else text


def _group_title(criterion: CriterionResult, segments: dict[str, Segment]) -> str:
    id_ = criterion.id.partition(".")[0]
    segment = segments.get(id_)
    if segment is None:
        return f"{id_} (not executed)" if criterion.verdict == "not_judged" else "Whole run"
    speed = labels.nominal(segment.initial_speed_km_h, "km/h")
    name = controller_of(segment) or segment.kind.capitalize()
    return f"{name}, {speed} ({segment.id})"


def _row(criterion: CriterionResult, definition: int, shown: set[str]) -> CriterionRow:
    decimals = _decimals(criterion)
    return CriterionRow(
        id=criterion.id,
        title=criterion.title or criterion.id.rpartition(".")[2].replace("_", " ").capitalize(),
        value=labels.number(criterion.value, decimals),
        unit="" if criterion.unit == "1" else labels.unit(criterion.unit),  # a share is a number
        limit=_limit(criterion),
        margin=labels.share(criterion.margin),
        verdict=criterion.verdict,
        unmet=criterion.failed or criterion.verdict in ("error", "not_judged"),
        reason=criterion.reason if criterion.reason not in shown else _AS_ABOVE,
        unmet_because=in_words(criterion) if criterion.reason not in shown else _AS_ABOVE,
        definition=definition,
    )


def _decimals(criterion: CriterionResult) -> int:
    """Four digits of the value, and more where its distance from a limit would round to nothing."""
    decimals = min(labels.decimals_for(criterion.value), _USUAL_DECIMALS)
    value, limits = criterion.value, (criterion.lower, criterion.upper)
    room = min((abs(limit - value) for limit in limits if limit is not None), default=0.0) if value else 0.0
    while room and room < 10.0**-decimals and decimals < _MOST_DECIMALS:
        decimals += 1
    return decimals


def _bound(value: float | None) -> str:
    """A limit as it was chosen; one that was measured (another segment's value) with five digits."""
    if value is not None and float(f"{value:.6g}") != value:
        return labels.number(value, significant=5)
    return labels.nominal(value)


def _limit(criterion: CriterionResult) -> str:
    lower, upper = _bound(criterion.lower), _bound(criterion.upper)
    if criterion.lower is not None and criterion.upper is not None:
        return f"{lower} to {upper}"
    if criterion.upper is not None:
        return f"{'<' if criterion.below else '≤'}{labels.THIN}{upper}"
    return f"≥{labels.THIN}{lower}" if criterion.lower is not None else labels.DASH
