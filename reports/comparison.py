"""The report of a comparison: criteria side by side, responses overlaid at the step, spectra in the band."""

from __future__ import annotations

import re
from dataclasses import replace

from hil.analysis.comparison import Comparison, CriterionRow, ResponseRow, differences, plan_summary
from hil.core.result import Segment
from reports import labels
from reports.labels import channel_label, criterion_title
from reports.members import controller_of
from reports.overlay_figures import overlay
from reports.parts import Page, Part, Table, page_html, page_pdf

_ROWS = 12  # of the first screen
_MOST_INPUTS, _LONGEST_VALUE = 40, 60
_MARKS = {"fail": " ✗", "undecided": " ?", "error": " !", "not_judged": " –"}


def comparison_html(found: Comparison) -> str:
    """The page: one file with interactive figures."""
    return page_html(_page(found))


def comparison_pdf(found: Comparison) -> bytes:
    """The same on paper: PDF/A-2a and PDF/UA-1."""
    return page_pdf(_page(found))


def lead(found: Comparison) -> str:
    """How far each run is from the first, in one sentence."""
    first, *others = found.runs
    lines = [
        f"{run.name} {labels.share(distance)}"
        for run, distance in zip(others, found.distances[1:], strict=True)
        if distance is not None
    ]
    if not lines:
        return f"No criterion has a value in every run; the reference is {first.name}."
    return f"Mean distance of the criteria from {first.name}: {', '.join(lines)}."


def plans_apart(found: Comparison) -> tuple[str, ...]:
    """What each further run's plan does or demands otherwise than the first one's, a line each."""
    lines = []
    for run in found.runs[1:]:
        apart = plan_summary(found.runs[0], run)
        if apart.shown:
            more = f"; and {apart.more} more" if apart.more else ""
            lines.append(f"The plan of {run.name} differs: {'; '.join(map(str, apart.shown))}{more}.")
    return tuple(lines)


def value_text(row: CriterionRow, run: int) -> str:
    """Value of a criterion in a run, how far it is from the first run's, and a mark where it failed."""
    value, relative = row.values[run], row.relative[run]
    text = labels.number(value, significant=4)
    if run and relative is not None:
        text += f" ({labels.share(relative, signed=True)})"
    return text + _MARKS.get(row.verdicts[run] or "", "")


def _page(found: Comparison) -> Page:
    plans = dict.fromkeys(run.result.plan for run in found.runs)
    return Page(
        kind="Runs side by side",
        title=f"{', '.join(plans)}: {len(found.runs)} runs",
        headline=f"Reference run: {found.runs[0].name}",
        tone="quiet",
        lead=lead(found),
        notes=(*plans_apart(found), *found.notes),
        parts=tuple(_parts(found)),
        first=_first(found),
    )


def _first(found: Comparison) -> Part | None:
    """The criteria that differ most from the first run's, and the response of the first of them."""
    names = tuple(run.name for run in found.runs)
    ranked = sorted(found.criteria, key=_difference_rank)
    if not ranked:
        return None
    rows = tuple(
        (
            criterion_title(row.id),
            *(value_text(row, run) for run in range(len(names))),
            labels.unit("" if row.unit == "1" else row.unit),
            _limit(row.limit),
        )
        for row in ranked[:_ROWS]
    )
    table = Table(("criterion", *names, "unit", "limit"), rows, 1, 1 + len(names))
    segments = {segment.id: segment for segment in found.runs[0].result.segments}
    drawn = segments.get(ranked[0].id.partition(".")[0])
    figures = overlay(found.runs, drawn)[:1] if drawn else ()
    text = f"Largest difference from {names[0]} first."
    wide = tuple(replace(figure, wide=True) for figure in figures)
    return Part("summary", "Criteria by difference", text, (table,), figures=wide)


def _difference_rank(row: CriterionRow) -> tuple[bool, float]:
    """The plan's own criteria first, each by its largest difference."""
    return not row.absolute, -max((abs(one or 0.0) for one in row.relative), default=0.0)


def _limit(text: str) -> str:
    """'≥ -10 ≤ 10' as '−10 to 10'."""
    both = re.fullmatch(r"≥ (\S+) ≤ (\S+)", text)
    joined = f"{both[1]} to {both[2]}" if both else text
    return re.sub(r"(?<!\S)-(?=\d)", labels.MINUS, joined)


def _parts(found: Comparison) -> list[Part]:
    names = tuple(run.name for run in found.runs)
    parts = [
        Part("runs", "Runs", "", (_runs(found),)),
        Part(
            "criteria",
            "Criteria",
            f"In brackets: difference from {names[0]}. ✗ beyond its limit, ! not to be computed, "
            "– not judged; a dash alone: no value, such as a response that did not settle.",
            (_criteria(found, names),) if found.criteria else (),
        ),
        Part(
            "responses",
            "Distance of the responses",
            f"Rms of the difference from {names[0]} over the rms of {names[0]} around its mean, the whole "
            "segment, aligned at the step. ≈: no more than steady ripple out of phase could make, so it "
            "proves no difference.",
            (_responses(found, names),),
        ),
    ]
    parts.append(Part("inputs", "Differences of the inputs", _INPUTS, _inputs(found)))
    parts += [_segment_part(found, segment) for segment in found.runs[0].result.segments]
    return [part for part in parts if part.tables or part.figures]


def _runs(found: Comparison) -> Table:
    rows = []
    for run, distance in zip(found.runs, found.distances, strict=True):
        about = run.recording.metadata.get("run", {})
        simulated = about.get("simulated", "").lower() == "true"
        share = labels.share(distance)
        rows.append(
            (
                run.name,
                ", ".join(map(str, run.result.variables)),
                run.result.bench,
                "simulated" if simulated else "measured",
                about.get("started_at", "")[:19].replace("T", " "),
                run.result.verdict,
                share,
            )
        )
    return Table(("run", "variables", "bench", "kind", "started", "verdict", "mean distance"), tuple(rows), 6)


_INPUTS = "Parameters of controllers, model, bench and plan that are not the same."


def _inputs(found: Comparison) -> tuple[Table, ...]:
    """What each further run was given otherwise than the first one, a table each."""
    first, *others = found.runs
    tables = []
    for other in others:
        inputs = differences(first, other)
        rows = [(str(one.kind), one.name, _cut(one.first), _cut(one.other)) for one in inputs[:_MOST_INPUTS]]
        left = len(inputs) - len(rows)
        rows += [(f"{left} further", "", "", "")] if left > 0 else []
        if rows:
            tables.append(Table(("file", "parameter", first.name, other.name), tuple(rows), 2))
    return tuple(tables)


def _cut(text: str) -> str:
    """A value on one line."""
    return text if len(text) <= _LONGEST_VALUE else f"{text[: _LONGEST_VALUE - 1]}…"


def _criteria(found: Comparison, names: tuple[str, ...]) -> Table:
    rows = [
        (
            criterion_title(row.id),
            *(value_text(row, run) for run in range(len(names))),
            labels.unit("" if row.unit == "1" else row.unit),
            _limit(row.limit),
        )
        for row in found.criteria
    ]
    return Table(("criterion", *names, "unit", "limit"), tuple(rows), 1, 1 + len(names))


def _responses(found: Comparison, names: tuple[str, ...]) -> Table:
    rows = [
        (
            row.segment,
            channel_label(row.channel).text,
            *(_gap(row, run) for run in range(len(names))),
        )
        for row in found.responses
    ]
    return Table(("segment", "channel", *names), tuple(rows), 2)


def _gap(row: ResponseRow, run: int) -> str:
    """How far a response is from the first run's, marked where ripple alone could make that."""
    within = run > 0 and row.within_ripple(run)
    return ("≈ " if within else "") + labels.share(row.gaps[run])


def _segment_part(found: Comparison, segment: Segment) -> Part:
    speed = labels.nominal(segment.initial_speed_km_h, "km/h")
    loaded = {
        other.controller for run in found.runs for other in run.result.segments if other.id == segment.id
    }
    same = len(loaded) == 1 and segment.controller
    name = controller_of(segment) if same else segment.kind.capitalize()
    return Part(segment.id, f"{name}, {speed} ({segment.id})", "", figures=overlay(found.runs, segment))
