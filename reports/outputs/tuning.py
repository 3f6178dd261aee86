"""What `hil tune` writes: controller, `tune.json`, figures, and the text for people."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from hil.analysis.tuning import (
    RefinedRun,
    Refinement,
    Standing,
    Tuning,
    front_of,
    metrics_of,
    point_of,
    values_of,
    within_hard_limits,
)
from hil.core.controller import Controller, controller_to_toml
from hil.core.errors.wording import share
from hil.core.result import Segment
from reports import drawings


def refinement_summary(found: Refinement, asked: Mapping[str, Any]) -> dict[str, Any]:
    """`refined` of tune.json; `asked` says on which bench, within what envelope, with whose consent."""
    return {
        **asked,
        "ended": found.ended,
        "best_run": None if found.best is None else found.best.number,
        "worst_margin": None if found.best is None else found.best.worst,
        "runs": [_run(run) for run in found.runs],
    }


def _run(run: RefinedRun) -> dict[str, Any]:
    return {
        "number": run.number,
        "values": dict(run.values),
        "trust_radius": run.radius,
        "predicted": dict(run.predicted.margins),
        "expected": dict(run.expected),
        "measured": dict(run.measured),
        "decision": run.decision,
        "reason": run.reason,
    }


def refinement_rows(found: Refinement) -> list[tuple[str, ...]]:
    """For each run: number, radius, worst margin predicted, expected, measured; decision and reason."""
    rows = []
    for run in found.runs:
        worst = (_worst(margins) for margins in (run.predicted.margins, run.expected, run.measured))
        rows.append((str(run.number), f"{run.radius:.3f}", *worst, run.decision, run.reason))
    return rows


REFINEMENT_HEAD = ("run", "radius", "predicted", "expected", "measured", "decision", "reason")


def refinement_verdict(found: Refinement) -> str:
    """What came of it, in a sentence or two."""
    if found.best is None:
        return f"Nothing was measured: {found.ended}."
    if len(found.runs) == 1:
        return f"One run: worst margin measured {share(found.best.worst)}. Ended: {found.ended}."
    gained = found.best.worst - found.runs[0].worst
    return (
        f"Run {found.best.number} of {len(found.runs)} is the best: worst margin measured "
        f"{share(found.best.worst)}, {share(gained)} of a limit more than the first run's. "
        f"Ended: {found.ended}."
    )


def _worst(margins: Mapping[str, float]) -> str:
    return share(min(margins.values()), 2) if margins else "–"


CONTROLLER, FREE = "controller.toml", "free.toml"


def output_files(found: Tuning, free_text: str, refined: RefinedRun | None = None) -> dict[str, bytes]:
    """Names and contents of everything but `tune.json` and the reports; `refined` is the best run's."""
    files = {CONTROLLER: controller_to_toml(_stated(found, refined)).encode(), FREE: free_text.encode()}
    pictures = _front_picture(found)
    if pictures is not None:
        files |= {f"front.{kind}": content for kind, content in pictures.items()}
    return files


def _stated(found: Tuning, refined: RefinedRun | None) -> Controller:
    """The controller with what it was tuned for, and what it came to where it was measured."""
    worst = found.chosen.worst
    meta = {
        "tuned_for": found.trial.plan.name,
        "in_place_of": found.trial.driven.file.stem,
        "worst_margin": worst.worst,
        "binding_criterion": worst.binding,
        "draws": len(found.trial.draws) - 1,
    }
    if refined is None:
        return found.chosen.controller.model_copy(update={"meta": meta})
    meta |= {"measured_worst_margin": refined.worst, "measured_in_run": refined.number}
    return refined.controller.model_copy(update={"name": found.chosen.controller.name, "meta": meta})


def _front_picture(found: Tuning) -> dict[str, bytes] | None:
    criteria = found.trial.driven.criteria
    metrics = metrics_of(criteria)
    best = front_of(found.archive, criteria)
    every = [point for one in found.archive if within_hard_limits(one) and (point := point_of(one, criteria))]
    if len(metrics) < 2 or not best:
        return None
    units = {criterion.metric.name: criterion.metric.unit for criterion in criteria}
    first, second = (f"{name.replace('_', ' ')} in {units[name]}" for name in metrics)
    labels = (first, second, "response time in s")
    named = {one.name: point.figures for one in found.shown if (point := point_of(one.nominal, criteria))}
    figure = drawings.front(
        labels, np.array([p.figures for p in every]), np.array([p.figures for p in best]), named
    )
    return drawings.render(figure)


def summary_of(
    found: Tuning, segments: tuple[Segment, ...], asked: Mapping[str, Any], files: list[str]
) -> dict[str, Any]:
    """The content of `tune.json`; `asked` are the options of the command."""
    trial, worst = found.trial, found.chosen.worst
    return {
        "failed_checks": list(found.failed_checks),
        "worse": [asdict(one) for one in found.worse],
        "held_by": list(found.held_by),
        **asked,
        "in_place_of": trial.driven.file.stem,
        "segments": list(trial.driven.segments),
        "worst_margin": worst.worst,
        "start_worst_margin": found.start.worst.worst,
        "binding": _binding(found, segments),
        "better_in_every_criterion": found.better_in_every_criterion,
        "traded": list(found.traded),
        "parameters": {
            name: {
                "value": found.chosen.values[name],
                "start": values_of(trial.start)[name],
                "lower": bounds[0],
                "upper": bounds[1],
            }
            for name, bounds in trial.free.free.items()
        },
        "criteria": [
            {
                "id": criterion.id,
                "unit": criterion.metric.unit,
                "upper": criterion.upper,
                "lower": criterion.lower,
                "below": criterion.below or "",
                "weight": trial.free.weight(criterion.id, criterion.metric.name),
                "controllers": {one.name: _of_criterion(one, criterion.id) for one in found.shown},
            }
            for criterion in trial.driven.criteria
        ],
        "hard_limits": {
            "limits": trial.free.limits.model_dump(),
            "controllers": {one.name: _hard_limits(one) for one in found.shown},
        },
        "kept": {
            **trial.free.keep.model_dump(),
            "controllers": {one.name: _kept(one) for one in found.shown},
        },
        "front": {
            "figures": [*metrics_of(trial.driven.criteria), "response_time"],
            "points": [
                {"values": dict(p.tried.values), "figures": list(p.figures)}
                for p in front_of(found.archive, trial.driven.criteria)
            ],
        },
        "sensitivities": {name: dict(row) for name, row in found.sensitivities.items()},
        "cars": [{"number": draw.number, "differs": dict(draw.differs)} for draw in trial.draws],
        "ended": found.ended,
        "runs": found.runs,
        "controller": CONTROLLER,
        "files": files,
    }


def _of_criterion(one: Standing, id_: str) -> dict[str, Any]:
    value = next((c.value for c in one.nominal.criteria if c.id == id_), None)
    return {
        "value": value,
        "margin": one.nominal.margins.get(id_),
        "least_margin": one.least_margin(id_),
        "worst_car": min(one.tried, key=lambda tried: tried.margins.get(id_, -1.0)).draw,
    }


def _hard_limits(one: Standing) -> dict[str, Any]:
    return {
        "kept_on_every_car": all(tried.feasible for tried in one.tried),
        "least_room": {name: min(t.limits.get(name, 0.0) for t in one.tried) for name in one.nominal.limits},
        "loop": asdict(one.nominal.loop),
    }


def _kept(one: Standing) -> dict[str, float | None]:
    """What must not get worse, on the model itself; a response that never comes has no time."""
    return {
        kept.limit.removeprefix("keep."): value if np.isfinite(value) else None
        for kept, value in one.nominal.figures.items()
    }


def _binding(found: Tuning, segments: tuple[Segment, ...]) -> dict[str, Any]:
    worst = found.chosen.worst
    criterion = next((c for c in found.trial.driven.criteria if c.id == worst.binding), None)
    segment = next((s for s in segments if criterion and s.id == criterion.segment), None)
    return {
        "criterion": worst.binding,
        "car": worst.draw,
        "differs": dict(found.trial.draws[worst.draw].differs),
        "initial_speed_km_h": None if segment is None else segment.initial_speed_km_h,
    }


def text_of(found: Tuning, out: str) -> str:
    """What a person reads."""
    width = max(len(c.id) for c in found.trial.driven.criteria)
    names = [one.name for one in found.shown]
    columns = "".join(f"{name:>16}" for name in names)
    lines = [*worse_in_words(found), "", f"{'margin, least of ' + _cars(found):<{width}}{columns}"]
    for criterion in found.trial.driven.criteria:
        cells = "".join(f"{share(one.least_margin(criterion.id)):>16}" for one in found.shown)
        lines.append(f"{criterion.id:<{width}}{cells}")
    lines.append("")
    own = values_of(found.trial.start)
    for name, value in found.chosen.values.items():
        lines.append(f"{name:<22}{value:>12.5g}   (was {own[name]:.5g})")
    if found.held_by:
        held = ", ".join(found.held_by)
        lines += ["", f"Held by what is kept: {held}. More margin may be had with --may-worsen NAME."]
    lines += ["", verdict(found), f"{found.runs} predicted runs, search {found.ended}; written to {out}"]
    return "\n".join(lines)


def verdict(found: Tuning) -> str:
    """What came out, in a sentence or two."""
    worst, before = found.chosen.worst, found.start.worst
    text = (
        f"Worst margin {share(worst.worst)} ({worst.binding}, {_car(worst.draw)}); "
        f"the plan's own controller has {_margin(found.start)} ({before.binding or 'not run'}, "
        f"{_car(before.draw)})."
    )
    if found.failed_checks:
        names = ", ".join(found.failed_checks)
        text = f"Fails what any device must do, as the plan's own controller does: {names}. {text}"
    elif found.worse:
        most = found.worst_figure
        others = f" and {len(found.worse) - 1} more" if len(found.worse) > 1 else ""
        text = f"Worse than at the start: {most.words} by {share(most.share)}{others}. {text}"
    if found.traded or found.failed_checks:
        return text
    rest = "" if found.worse else ", and nothing else is worse"
    return f"{text} Margin increased for every criterion{rest}."


def worse_in_words(found: Tuning) -> list[str]:
    """What is worse than with the start, a line each; and what was allowed."""
    keep = found.trial.free.keep
    let_go = f"; let go: {', '.join(keep.may_worsen)}" if keep.may_worsen else ""
    allowed = f"allowed: {keep.share_percent:g} % of the start's figure{let_go}"
    if found.start_fails:
        allowed = "the plan's own controller fails the plan, so that nothing of it is kept but hard limits"
    if not found.worse:
        kept = "criteria, response time, steady error, torque effort, stability"
        return [f"{kept}: none is worse than at the start ({allowed})"]
    lines = [f"worse than at the start ({allowed}):"]
    width = max(len(one.words) for one in found.worse)
    for one in found.worse:
        car = "" if len(found.trial.draws) == 1 else f", {_car(one.car)}"
        change = f"{one.start:.4g} to {one.value:.4g} {one.unit}".rstrip()
        lines.append(f"  {one.words:<{width}}{share(one.share):>8}   {change}{car}")
    return lines


def _margin(one: Standing) -> str:
    return share(one.worst.worst) if one.worst.feasible else "none within the hard limits"


def _car(number: int) -> str:
    return "nominal model" if number == 0 else f"draw {number}"


def _cars(found: Tuning) -> str:
    count = len(found.trial.draws)
    return "the model" if count == 1 else f"{count} cars"
