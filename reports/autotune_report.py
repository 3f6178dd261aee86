"""The report of `hil autotune`: every decision with its reason, what was named, margins and responses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from hil.analysis.comparison import ComparedRun
from hil.core.result import RunResult
from reports import labels
from reports.figure import Figure
from reports.labels import criterion_title
from reports.origin import Origin
from reports.outputs.autotune import Closing, closing_verdict
from reports.overlay_figures import overlay
from reports.parts import Page, Part, Table
from reports.tuning_report import Shown


def autotune_page(
    closing: Closing,
    shown: Sequence[Shown],
    segments: Sequence[str],
    title: str,
    consented: str,
    origin: Origin,
) -> Page:
    """The page; `shown` are the runs whose responses are compared, in `segments`."""
    best = closing.best
    return Page(
        kind="Autotune",
        title=title,
        headline="No controller confirmed"
        if best is None
        else f"Worst margin measured {labels.share(best.worst)}",
        tone="pass" if closing.content else "fail",
        lead=closing_verdict(closing),
        notes=(consented,),
        parts=(*_parts(closing), *_responses(closing, shown, segments), origin.part),
        mark=origin.mark,
        first=_first(closing, shown, segments),
    )


def _first(closing: Closing, shown: Sequence[Shown], segments: Sequence[str]) -> Part | None:
    """Margins before and after, and the response of the criterion with the least measured one."""
    if closing.best is None:
        return None
    measured = closing.best.measured
    worst = min(measured, key=lambda name: measured[name]).partition(".")[0]
    drawn = _responses(closing, shown, segments)
    part = next((one for one in drawn if one.id == worst), drawn[0] if drawn else None)
    first = part.figures[:1] if part else ()
    figures = tuple(replace(figure, wide=True) for figure in first if isinstance(figure, Figure))
    words = "Before: the plan's own controller, measured. The others: the best run."
    return Part("margins", "Margins", words, (_margins(closing),), figures=figures)


def _parts(closing: Closing) -> list[Part]:
    parts = [
        Part(
            "decisions",
            "Decisions",
            "Each stage in its order; its folder has its own report.",
            (_decisions(closing),),
        )
    ]
    if closing.diagnosis is not None and closing.diagnosis.effects:
        words = "By the newest diagnosis, with the chance that a name is right."
        parts.append(Part("named", "What the model lacked", words, (_effects(closing),)))
    return parts


def _decisions(closing: Closing) -> Table:
    rows = tuple(
        (str(one.round), one.stage, one.found, one.decided, one.why, one.folder) for one in closing.decisions
    )
    return Table(("round", "stage", "found", "decided", "why", "folder"), rows, numbers_from=9)


def _effects(closing: Closing) -> Table:
    assert closing.diagnosis is not None
    rows = []
    for effect in closing.diagnosis.effects:
        for name, value in effect.use.values.items():
            if name not in effect.standard_error:
                continue
            error = labels.number(effect.standard_error[name])
            number = value if isinstance(value, str) else labels.number(value)
            rows.append((effect.use.id, labels.chance(effect.confidence), name, number, error))
    return Table(("effect", "chance", "parameter", "value", "standard error"), tuple(rows), 3)


def _margins(closing: Closing) -> Table:
    best = closing.best
    assert best is not None
    rows = [
        (
            criterion_title(name),
            labels.share(closing.before_margins.get(name)),
            *(labels.share(of[name]) for of in (best.predicted.margins, best.expected, best.measured)),
        )
        for name in best.measured
    ]
    least = (best.predicted.margins, best.expected, best.measured)
    rows.append(
        (
            "worst",
            labels.share(closing.before_worst),
            *(labels.share(min(of.values())) for of in least),
        )
    )
    return Table(("criterion", "before", "predicted", "expected", "measured"), tuple(rows))


def _responses(closing: Closing, shown: Sequence[Shown], segments: Sequence[str]) -> list[Part]:
    if not shown or closing.best is None:
        return []
    compared = tuple(_compared(run) for run in shown)
    driven = [segment for segment in shown[0].segments if segment.id in segments]
    return [
        Part(segment.id, f"Responses: {segment.id}", "", figures=overlay(compared, segment))
        for segment in driven
    ]


def _compared(run: Shown) -> ComparedRun:
    result = RunResult(
        verdict="pass",
        plan="",
        bench="",
        real_time_factor=0.0,
        bench_time_s=0.0,
        safe_state="not_needed",
        segments=run.segments,
    )
    return ComparedRun(run.name, run.recording, result)
