"""`hil tune --on-bench`: refines what was found where it is measured, and tells of every run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from hil.analysis.tuning import Refinement, RefinementBudget, Tuning, refine
from hil.cli._on_bench import FOLDER, Allowed, WireBench
from hil.cli._output import console, note, plain_table
from reports.outputs.refinement import (
    REFINEMENT_HEAD,
    refinement_rows,
    refinement_summary,
    refinement_verdict,
)
from reports.tuning_report import Shown


@dataclass(frozen=True)
class Refined:
    """What the runs came to; `exit_code` is the largest of runs that failed or were interrupted, or 0."""

    found: Refinement
    allowed: Allowed
    shown: Shown | None
    exit_code: int

    def as_json(self) -> dict[str, Any]:
        """`refined` of tune.json."""
        return refinement_summary(self.found, {**self.allowed.as_json(), "folder": FOLDER})

    def tell(self) -> None:
        """The runs as a table."""
        page, table = console(), plain_table("\non the bench: worst margins")
        for number, name in enumerate(REFINEMENT_HEAD):
            table.add_column(name, justify="right" if number < 5 else "left", no_wrap=number < 6)
        for row in refinement_rows(self.found):
            table.add_row(*row)
        page.print(table)
        page.print(refinement_verdict(self.found), highlight=False, markup=False, soft_wrap=True)


def refined(
    found: Tuning,
    wire: WireBench,
    budget: RefinementBudget,
    processes: int | None,
    stopped: Callable[[], bool],
) -> Refined:
    """Refine on `wire` the controller that was found on the model."""
    came = refine(
        found.trial,
        found.space,
        found.space.point(found.chosen.values),
        wire,
        budget=budget,
        processes=processes,
        show=lambda text, share: note(text),
        stopped=lambda: stopped() or wire.exit_code > 0,
    )
    shown = None if came.best is None else wire.carried[came.best.number].shown("measured")
    return Refined(came, wire.allowed, shown, wire.exit_code)
