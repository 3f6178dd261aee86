"""The part of a tuning's report that tells of its runs on a bench, each with its decision and its reason."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from hil.analysis.tuning import RefinedRun, Refinement
from reports import labels
from reports.figure import Figure, Trace
from reports.labels import Label, criterion_title
from reports.outputs.tuning import REFINEMENT_HEAD, refinement_rows, refinement_verdict
from reports.parts import Page, Part, Table

_TEXT = (
    "Worst margins. Predicted: by the model. Expected: as earlier runs correct that. Radius: of the "
    "trust region around the best run so far, in ranges of the parameters."
)

_WORTH_A_LINE = 3  # points


def refined_page(page: Page, found: Refinement, consented: str) -> Page:
    """A tuning's page with its runs on a bench before everything else."""
    best = found.best
    return replace(
        page,
        headline="Nothing was measured"
        if best is None
        else f"Worst margin measured {labels.share(best.worst)}",
        tone="fail" if best is None or best.worst < 0 else "pass",
        lead=f"{refinement_verdict(found)} On the model: {page.lead}",
        parts=(*refinement_parts(found, consented), *page.parts),
        first=_first(page.first, best, found),
    )


def _first(of_model: Part | None, best: RefinedRun | None, found: Refinement) -> Part | None:
    """What was measured in place of what was predicted; the figure of the binding criterion stays."""
    if best is None or of_model is None:
        return of_model
    return replace(of_model, title="Measured margins", tables=(_margins(found, best),))


def refinement_parts(found: Refinement, consented: str) -> tuple[Part, ...]:
    """The runs, and the margins of the first and the best; `consented` says to what, by whom."""
    runs = Table(REFINEMENT_HEAD, tuple(refinement_rows(found)), 1, 5)
    figures = (_figure(found),) if sum(bool(run.measured) for run in found.runs) >= _WORTH_A_LINE else ()
    first = Part("bench", "On the bench", f"{_TEXT} {consented}", (runs,), figures=figures)
    if found.best is None:
        return (first,)
    return first, Part("measured", "Measured margins", "", (_margins(found, found.best),))


def _margins(found: Refinement, best: RefinedRun) -> Table:
    """Each criterion in the first and in the best run."""
    first = found.runs[0]
    rows = [
        (
            criterion_title(name),
            *(labels.share(one[name]) for one in (first.predicted.margins, first.measured)),
            *(labels.share(one[name]) for one in (best.predicted.margins, best.measured)),
        )
        for name in best.measured
    ]
    head = ("margin", "first, predicted", "first, measured", "best, predicted", "best, measured")
    return Table(head, tuple(rows))


def _figure(found: Refinement) -> Figure:
    measured = [run for run in found.runs if run.measured]
    numbers = np.array([run.number for run in measured], float)
    series = {
        "predicted": (np.array([min(run.predicted.margins.values()) for run in measured]), "gain", "dash"),
        "expected": (np.array([min(run.expected.values()) for run in measured]), "reference", "dot"),
        "measured": (np.array([run.worst for run in measured]), "phase", "solid"),
    }
    return Figure(
        id="refined-margin",
        title=Label("Worst margin from run to run"),
        x_text="run",
        x_unit="",
        y_label=Label("worst margin"),
        y_unit="%",
        traces=tuple(
            Trace(Label(name), numbers, 100 * values, role, dash)
            for name, (values, role, dash) in series.items()
        ),
        wide=True,
    )
