"""The report of `hil tune`: the controller, what binds it, what was traded, steps and spectra overlaid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from hil.analysis.comparison import ComparedRun
from hil.analysis.tuning import (
    DEVICE_LIMIT,
    ENVELOPE_LIMIT,
    PARAMETERS,
    Confirmation,
    Standing,
    Tuning,
    values_of,
    within_hard_limits,
)
from hil.core.channels import CHANNELS
from hil.core.recording import Recording
from hil.core.result import RunResult, Segment
from reports import labels
from reports.figure import Figure, Level
from reports.front_figures import front_figures
from reports.labels import Label, criterion_title
from reports.origin import Origin
from reports.outputs.tuning import verdict, worse_in_words
from reports.overlay_figures import overlay, overlay_slip
from reports.parts import Cell, Map, Page, Part, Table
from test_plans.criteria import Criterion
from test_plans.metrics import WheelSlip

_ROWS = 12  # of the first screen
_LEADS = "Least margin over all vehicles, weighted; in brackets: of the nominal model."

_LIMITS = {
    "sensitivity_peak": "|S|max",
    "gain_margin_db": "gain margin, dB",
    "phase_margin_deg": "phase margin, °",
    "delay_margin_s": "delay margin, s",
    "motor_torque_nm": "motor torque, N m",
    "motor_energy_j": "motor energy, J",
}


@dataclass(frozen=True)
class Shown:
    """One of the compared controllers with a whole predicted run on the model itself."""

    name: str
    recording: Recording
    segments: tuple[Segment, ...]


def tuning_page(
    found: Tuning,
    runs: Sequence[Shown],
    title: str,
    origin: Origin,
    confirmed: Confirmation | None = None,
) -> Page:
    """The page; `confirmed` is what a run came to."""
    worst = found.chosen.worst
    notes = ["The search was interrupted: this is what was best then."] if found.ended == "stopped" else []
    return Page(
        kind="Tuning",
        title=title,
        headline=_headline(found),
        tone="pass" if worst.worst >= 0 and not found.failed_checks else "fail",
        lead=_in_titles(verdict(found), found),
        notes=tuple(notes),
        parts=(
            Part("kept", "Compared with the start", _kept_text(found), (_kept(found),)),
            *_confirmed(confirmed),
            *_parts(found, runs, origin),
        ),
        mark=origin.mark,
        first=_first(found, runs),
    )


def _headline(found: Tuning) -> str:
    if found.failed_checks:
        return "The controller fails what any device must do"
    return f"Worst margin {labels.share(found.chosen.worst.worst)}"


def _first(found: Tuning, runs: Sequence[Shown]) -> Part:
    """The margins of the tuned controller beside the start's, the least first, and the binding response."""
    ranked = sorted(found.trial.driven.criteria, key=lambda one: found.chosen.least_margin(one.id))
    rows = tuple(
        (
            criterion_title(criterion.id),
            _limit(criterion),
            labels.share(found.start.least_margin(criterion.id)),
            labels.share(found.chosen.least_margin(criterion.id)),
        )
        for criterion in ranked[:_ROWS]
    )
    table = Table(("criterion", "limit", "margin, start", "margin, tuned"), rows, 1)
    binding = next((one for one in ranked if one.id == found.chosen.worst.binding), ranked[0])
    segment = next((s for s in (runs[0].segments if runs else ()) if s.id == binding.segment), None)
    compared = tuple(_compared(run, found) for run in runs)
    shown = _binding_figure(compared, binding, segment) if segment else None
    title = f"Binding criterion: {criterion_title(binding.id)}"
    levels: tuple[Level, ...] = shown.levels if shown else ()
    if binding.metric.name.startswith("peak") and binding.upper is not None and not binding.below:
        levels = (Level(binding.upper, f"Limit {_limit(binding)[2:]}, {binding.segment}"),)
    drawn = (replace(shown, title=Label(title), wide=True, levels=levels),) if shown else ()
    return Part("summary", "Criteria by margin", "", (table,), figures=drawn)


def _binding_figure(compared: tuple[ComparedRun, ...], binding: Criterion, segment: Segment) -> Figure | None:
    """What the binding criterion judges, of every run."""
    if isinstance(binding.metric, WheelSlip):
        return overlay_slip(compared, segment, binding.metric.channel, binding.upper)
    wanted = "spectrum" if "band_energy" in binding.id else "first"
    return next((one for one in overlay(compared, segment) if one.id.endswith(wanted)), None)


def _in_titles(text: str, found: Tuning) -> str:
    """A sentence with the criteria's titles in place of their ids, the longest id first."""
    criteria = (*found.trial.driven.criteria, *found.trial.device_checks)
    for id_ in sorted((one.id for one in criteria), key=len, reverse=True):
        text = text.replace(id_, criterion_title(id_))
    return text


def _limit(criterion: Criterion) -> str:
    if criterion.below:
        return f"< {criterion.below}"
    unit = labels.unit(criterion.metric.unit)
    bounds = [f"≥ {labels.nominal(criterion.lower)}"] if criterion.lower is not None else []
    bounds += [f"≤ {labels.nominal(criterion.upper)}"] if criterion.upper is not None else []
    return " ".join([*bounds, unit]) if bounds else labels.DASH


def _parts(found: Tuning, runs: Sequence[Shown], origin: Origin) -> list[Part]:
    parts = [
        Part("margins", "Margins", _margins_text(found), (_margins(found),)),
        Part("limits", "Hard limits", _limits_text(found), (_limits(found),)),
        *_device(found),
        Part("parameters", "Parameters", "", (_parameters(found),)),
        Part("binding", "Binding criteria", _binding_text(found), (_binding(found),)),
    ]
    drawn = front_figures(found)
    if drawn:
        words = (
            "Largest values over the driven segments, nominal model, of every candidate within the hard "
            "limits, also of those that are slower than is allowed. Pareto front: candidates that no other "
            "beats in peak, band energy and response time at once."
        )
        parts.append(Part("front", "Trade-off", words, figures=drawn))
    if found.sensitivities:
        parts.append(
            Part(
                "sensitivities",
                "Sensitivities",
                "Change of margin, percentage points, per 10 % of a parameter's range, on the nominal model. "
                "Red: the margin rises with the parameter; blue: it falls.",
                maps=(_sensitivities(found),),
            )
        )
    first = runs[0].segments if runs else ()
    compared = tuple(_compared(run, found) for run in runs)
    for segment in first:
        if segment.id in found.trial.driven.segments:
            parts.append(Part(segment.id, f"Responses: {segment.id}", "", figures=overlay(compared, segment)))
    parts.append(
        Part(
            "search",
            "The search",
            f"{found.runs} predicted runs of the plan; {found.ended}. Multi-start sequential linear "
            "programming on the nominal model, then on a growing set of sampled vehicles.",
        )
    )
    return [*parts, origin.part]


def _confirmed(found: Confirmation | None) -> tuple[Part, ...]:
    """Predicted and measured side by side, if it was run."""
    if found is None:
        return ()
    rows = tuple(
        (
            criterion_title(one.id),
            labels.number(one.predicted.value),
            labels.number(one.measured.value),
            labels.number(one.difference, significant=3),
            labels.unit(one.unit),
            labels.share(one.apart, 2) if one.of_limit else labels.DASH,
            one.measured.verdict,
        )
        for one in found.criteria
    )
    words = "as predicted" if found.agrees else "not as predicted: see the diagnosis"
    allowed = labels.share(found.allowed)
    text = (
        f"The first run with the tuned controller. Allowed: {allowed} of a limit, of the larger value where "
        f"there is none; {words}."
    )
    head = ("criterion", "predicted", "measured", "difference", "unit", "of the limit", "run")
    return (Part("confirmed", "Predicted and measured", text, (Table(head, rows, 1, 6),)),)


def _compared(run: Shown, found: Tuning) -> ComparedRun:
    result = RunResult(
        verdict="pass",
        plan=found.trial.plan.name,
        bench="predicted",
        real_time_factor=0.0,
        bench_time_s=0.0,
        safe_state="not_needed",
        segments=run.segments,
    )
    return ComparedRun(run.name, run.recording, result)


def _margins_text(found: Tuning) -> str:
    """An interrupted search compares nothing beside the start."""
    same = found.ended != "stopped" and all(one.name != "paper's lead" for one in found.others)
    return f"{_LEADS} The start has the paper's lead." if same else _LEADS


def _margins(found: Tuning) -> Table:
    names = tuple(one.name for one in found.shown)
    rows = [
        (criterion_title(criterion.id), *(_margin(one, criterion.id) for one in found.shown))
        for criterion in found.trial.driven.criteria
    ]
    rows.append(("worst", *(_worst(one, found) for one in found.shown)))
    return Table(("criterion", *names), tuple(rows))


def _worst(one: Standing, found: Tuning) -> str:
    if not all(within_hard_limits(tried) for tried in one.tried):
        return "none"
    return labels.share(min(one.least_margin(criterion.id) for criterion in found.trial.driven.criteria))


def _margin(one: Standing, id_: str) -> str:
    least = labels.share(one.least_margin(id_)) if all(t.margins for t in one.tried) else labels.DASH
    if len(one.tried) == 1:
        return least
    own = one.nominal.margins.get(id_)
    return f"{least} ({labels.share(own)})"


def _kept_text(found: Tuning) -> str:
    first = worse_in_words(found)[0].rstrip(":")
    held = f" Held by what is kept: {', '.join(found.held_by)}." if found.held_by else ""
    return f"{first[0].upper()}{first[1:]}.{held}"


def _kept(found: Tuning) -> Table:
    """What must not get worse, what is worse first."""
    shares = {one.words: one for one in found.worse}
    known = {kept.words for kept in found.start.nominal.figures}
    rows = [
        (
            -1.0 - one.share,
            (
                one.words,
                labels.number(one.start),
                labels.number(one.value),
                labels.unit(one.unit),
                labels.share(one.share),
            ),
        )
        for one in found.worse
        if one.words not in known
    ]
    for kept, start in found.start.nominal.figures.items():
        value = found.chosen.nominal.figures.get(kept, float("nan"))
        worst = shares.get(kept.words)
        rows.append(
            (
                -(worst.share if worst else 0.0),
                (
                    kept.words,
                    labels.number(start),
                    labels.number(value),
                    labels.unit(kept.unit),
                    labels.share(worst.share) if worst else "not worse",
                ),
            )
        )
    rows.sort(key=lambda row: row[0])
    head = ("figure", "start", "tuned", "unit", "worse by, at most on any vehicle")
    return Table(head, tuple(row for _, row in rows), 1)


def _limits_text(found: Tuning) -> str:
    count = len(found.trial.draws)
    cars = "nominal model" if count == 1 else f"least over the nominal model and {count - 1} sampled vehicles"
    return f"Distance to the limits, % of each, {cars}. Margins are of the sampled loop."


def _limits(found: Tuning) -> Table:
    names = tuple(one.name for one in found.shown)
    rows = []
    for name in found.chosen.nominal.limits:
        if name.startswith(("keep.", DEVICE_LIMIT)):
            continue
        cells = (
            labels.share(min(t.limits.get(name, float("nan")) for t in one.tried)) for one in found.shown
        )
        rows.append((*_limit_with_value(found, name), *cells))
    return Table(("limit", "value", *names), tuple(rows))


def _limit_with_value(found: Tuning, name: str) -> tuple[str, str]:
    """A hard limit in words and its value."""
    if name.startswith(ENVELOPE_LIMIT):
        channel = name.removeprefix(ENVELOPE_LIMIT)
        limit = labels.quantity(found.trial.envelope[channel], CHANNELS[channel].unit)
        return f"largest {labels.with_titles(channel)} of a run", limit
    value = getattr(found.trial.free.limits, name)
    shown = "yes" if isinstance(value, bool) else labels.nominal(value)
    return _LIMITS.get(name, name.replace("_", " ")), shown


def _device(found: Tuning) -> tuple[Part, ...]:
    """What any device must do in the driven segments, and whether each controller does."""
    rows = tuple(
        (
            criterion_title(check.id),
            _limit(check),
            *(_least_of_check(one, check.id) for one in found.shown),
        )
        for check in found.trial.device_checks
    )
    if not rows:
        return ()
    text = (
        "Margin of what is asked of every device, least over all vehicles. No controller is chosen that "
        "fails one which the start keeps."
    )
    head = ("check", "limit", *(one.name for one in found.shown))
    return (Part("device", "What any device must do", text, (Table(head, rows, 1),)),)


def _least_of_check(one: Standing, id_: str) -> str:
    known = [tried.device[id_] for tried in one.tried if id_ in tried.device]
    return labels.share(min(known)) if known else labels.DASH


def _parameters(found: Tuning) -> Table:
    own = values_of(found.trial.start)
    rows = [
        (
            PARAMETERS[name].words,
            labels.number(value),
            labels.number(own[name]),
            *(labels.nominal(bound) for bound in found.trial.free.free[name]),
            labels.unit(PARAMETERS[name].unit),
        )
        for name, value in found.chosen.values.items()
    ]
    return Table(("parameter", "tuned", "start", "from", "to", "unit"), tuple(rows), 1, 5)


def _binding_text(found: Tuning) -> str:
    at_bound = [
        name
        for name, (low, high) in found.trial.free.free.items()
        if min(found.chosen.values[name] - low, high - found.chosen.values[name]) < 1e-3 * (high - low)
    ]
    sentence = "The vehicles with the least margins and the binding criterion of each."
    names = ", ".join(PARAMETERS[name].words for name in at_bound)
    return f"{sentence} At a bound: {names}; wider bounds may give more." if at_bound else sentence


def _binding(found: Tuning) -> Table:
    rows = []
    for tried in sorted(found.chosen.tried, key=lambda one: one.worst)[:5]:
        differs = found.trial.draws[tried.draw].differs
        words = ", ".join(f"{name} {labels.number(value)}" for name, value in differs.items())
        car = "nominal model" if tried.draw == 0 else f"draw\u00a0{tried.draw}"
        rows.append((car, labels.share(tried.worst), criterion_title(tried.binding), words))
    return Table(
        ("vehicle", "worst margin", "binding criterion", "deviation from nominal"), tuple(rows), 1, 2
    )


def _sensitivities(found: Tuning) -> Map:
    largest = max(
        (abs(v) for row in found.sensitivities.values() for v in row.values() if np.isfinite(v)), default=1.0
    )
    rows = tuple(
        (
            criterion_title(criterion),
            tuple(
                Cell(
                    labels.number(10 * value, 1),
                    min(1.0, abs(value) / largest) if np.isfinite(value) else 0.0,
                    value < 0,
                )
                for value in row.values()
            ),
        )
        for criterion, row in found.sensitivities.items()
    )
    return Map("", ("criterion", *(PARAMETERS[name].symbol for name in found.space.names)), rows)
