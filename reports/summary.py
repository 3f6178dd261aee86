"""The first screen of a run's report: each criterion with value and limit, and the picture that decides."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from hil.core.recording import Recording
from hil.core.result import CriterionResult, RunResult
from reports import labels
from reports.criteria import CriteriaTable, CriterionRow
from reports.deciding_figure import deciding_figure
from reports.figure import Figure
from reports.labels import Label, pieces

MOST_ROWS = 12


@dataclass(frozen=True)
class SummaryRow:
    """A criterion on one line; `segment` is '' for the whole run."""

    id: str
    title: str
    segment: str
    value: str
    limit: str
    margin: str
    verdict: str
    unmet: bool


@dataclass(frozen=True)
class Summary:
    """Criteria with a limit, those not met first, then by margin; `further` says what is left out."""

    rows: tuple[SummaryRow, ...]
    further: str
    figure: Figure | None


def summary(recording: Recording, result: RunResult, table: CriteriaTable) -> Summary | None:
    """The first screen; None without a criterion that has a limit."""
    rows = {row.id: row for group in table.groups for row in group.rows}
    ranked = sorted((c for c in result.criteria if c.has_limit), key=_rank)
    shown = [c for c in ranked if c.source == "plan" or rows[c.id].unmet]
    if not shown:
        return None
    left = len(ranked) - len(shown[:MOST_ROWS])
    return Summary(
        tuple(_row(rows[c.id]) for c in shown[:MOST_ROWS]),
        _further(left, passed=not any(rows[c.id].unmet for c in shown[MOST_ROWS:])),
        _figure(recording, result, shown, rows),
    )


def _rank(criterion: CriterionResult) -> tuple[int, float]:
    """Not met comes first, and of those what has a value to be shown; then the least margin."""
    margin = math.inf if criterion.margin is None else criterion.margin
    if criterion.failed:
        return 0, margin
    return (1 if criterion.verdict in ("error", "not_judged") else 2), margin


def _row(row: CriterionRow) -> SummaryRow:
    segment = row.id.partition(".")[0] if "." in row.id else ""
    unit = f"{labels.THIN}{row.unit}" if row.unit else ""
    value = row.value if row.value == labels.DASH else row.value + unit
    limit = row.limit if row.limit == labels.DASH else row.limit + unit
    return SummaryRow(row.id, row.title, segment, value, limit, row.margin, row.verdict, row.unmet)


def _further(count: int, *, passed: bool) -> str:
    if not count:
        return ""
    what = "criterion or device check" if count == 1 else "criteria and device checks"
    return f"{count} further {what}{' passed' if passed else ''}: see Criteria."


def _with_symbol(text: str) -> Label:
    """The words with the first symbol of a channel in them set as such."""
    found = pieces(text)
    at = next((n for n, (_, known) in enumerate(found) if known), None)
    if at is None:
        return Label(text)
    before, after = ("".join(piece for piece, _ in part) for part in (found[:at], found[at + 1 :]))
    return Label(before.rstrip(), found[at][0], after)


def _figure(
    recording: Recording, result: RunResult, ranked: list[CriterionResult], rows: dict[str, CriterionRow]
) -> Figure | None:
    """Of the first criterion that can be drawn."""
    for criterion in ranked:
        figure = deciding_figure(recording, result, criterion)
        if figure is not None:
            row = _row(rows[criterion.id])
            word = "Not met" if row.unmet else "Least margin"
            lines = [f"{row.value}", f"limit {row.limit}" + (f" ({criterion.below})" * bool(criterion.below))]
            lines += [f"margin {row.margin}"] if row.margin != labels.DASH else []
            title = _with_symbol(f"{word}: {row.title}, {row.segment}")
            caption = f"{row.segment}: {', '.join(lines)}. {figure.caption}".strip()
            return replace(figure, title=title, caption=caption, wide=True)
    return None
