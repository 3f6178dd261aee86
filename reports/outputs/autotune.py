"""What `hil autotune` says of its rounds: JSON, and the text for people."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, Literal

from hil.analysis.diagnosis import Diagnosis
from hil.analysis.tuning import Confirmation, Kept, RefinedRun, Worse, worse_of
from hil.core.errors.wording import share
from reports.labels import chance

Stage = Literal["consent", "identify", "before", "diagnose", "tune", "confirm"]


@dataclass(frozen=True)
class Decision:
    """What a stage found, what was decided, and why; `folder` has all of it. Round 0: before the first."""

    round: int
    stage: Stage
    found: str
    decided: str
    why: str
    folder: str = ""


@dataclass
class Closing:
    """The loop so far.

    Attributes:
        asked: what was asked for, with the consent and its envelope.
        decisions: in order.
        before: the plan with its own controllers, predicted by the model that was given and measured.
        before_margins: measured margins of the controller that is tuned, by criterion.
        diagnosis: the newest.
        best: the run with the largest worst margin of those that came out as predicted, else of all.
        best_round: where it was.
        start_figures: what is kept, of the plan's own controller on the model of that round.
        agrees: whether the confirming run of the round that the best controller is of came out as predicted.
        ended: why there was no other round; '' while it goes on.
    """

    asked: Mapping[str, Any]
    decisions: list[Decision] = field(default_factory=list)
    before: Confirmation | None = None
    before_margins: Mapping[str, float] = field(default_factory=dict)
    diagnosis: Diagnosis | None = None
    best: RefinedRun | None = None
    best_round: int = 0
    start_figures: Mapping[Kept, float] = field(default_factory=dict)
    agrees: bool = False
    ended: str = ""

    @property
    def before_worst(self) -> float | None:
        """The least measured margin of the plan's own controller."""
        return min(self.before_margins.values(), default=None)

    @property
    def traded(self) -> tuple[str, ...]:
        """Criteria in which the plan's own controller had more margin on the bench than the best has."""
        measured = {} if self.best is None else self.best.measured
        return tuple(
            name for name, margin in measured.items() if margin < self.before_margins.get(name, margin)
        )

    @property
    def worse(self) -> tuple[Worse, ...]:
        """What the best controller is predicted to be worse in than the plan's own, beside the criteria."""
        return () if self.best is None else worse_of([self.start_figures], [self.best.predicted.figures])

    @property
    def content(self) -> bool:
        """Whether prediction and run agree, and nothing that depends on the controller fails."""
        return self.agrees and self.best is not None and self.best.worst >= 0


def closing_summary(closing: Closing, files: list[str]) -> dict[str, Any]:
    """The content of `autotune.json`."""
    best, found = closing.best, closing.diagnosis
    return {
        "worse": [asdict(one) for one in closing.worse],
        **closing.asked,
        "ended": closing.ended,
        "agrees": closing.agrees,
        "worst_margin": {
            "before": closing.before_worst,
            "predicted": None if best is None else min(best.predicted.margins.values()),
            "measured": None if best is None else best.worst,
        },
        "margins": {} if best is None else {name: _margins(closing, name) for name in best.measured},
        "traded": list(closing.traded),
        "effects": [] if found is None else found.as_json()["effects"],
        "parameter_updates": {} if found is None else found.as_json()["parameter_updates"],
        "best": {} if best is None else {"round": closing.best_round, "run": best.number},
        "values": {} if best is None else dict(best.values),
        "decisions": [asdict(decision) for decision in closing.decisions],
        "files": files,
    }


def _margins(closing: Closing, name: str) -> dict[str, float | None]:
    assert closing.best is not None
    return {
        "before": closing.before_margins.get(name),
        "predicted": closing.best.predicted.margins[name],
        "expected": closing.best.expected[name],
        "measured": closing.best.measured[name],
    }


def closing_verdict(closing: Closing) -> str:
    """What came of it, in a sentence or two."""
    before, best = closing.before_worst, closing.best
    if best is None:
        return f"No controller was confirmed: {closing.ended or 'not yet'}."
    own = "" if before is None else f"; the plan's own controller has {share(before)} on that bench"
    how = "as predicted" if closing.agrees else "not as predicted"
    names = ", ".join(name.replace(".", " ") for name in closing.traded)
    less = f" Margin decreased for: {names}." if names else ""
    kept = [f"{one.words} by {share(one.share)}" for one in closing.worse]
    worse = f"Worse than with the plan's own controller, as predicted: {'; '.join(kept)}. " if kept else ""
    return (
        f"{worse}Worst margin measured {share(best.worst)} (round {closing.best_round}, run {best.number}), "
        f"{how}{own}.{less} Ended: {closing.ended or 'not yet'}."
    )


def effects_in_words(found: Diagnosis) -> str:
    """Names with their numbers: "backlash (90%): half_gap_rad = 0.01"."""
    lines = []
    for effect in found.effects:
        numbers = ", ".join(
            f"{name} = {value}" if isinstance(value, str) else f"{name} = {value:.4g}"
            for name, value in effect.use.values.items()
            if name in effect.standard_error or isinstance(value, str)
        )
        lines.append(f"{effect.use.id} ({chance(effect.confidence)}): {numbers}")
    return "; ".join(lines)
