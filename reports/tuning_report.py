"""The report of `hil tune`: the controller, what binds it, what was traded, steps and spectra overlaid."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from hil.analysis.comparison import ComparedRun
from hil.analysis.tuning import PARAMETERS, Confirmation, Standing, Tuning, values_of
from hil.core.recording import Recording
from hil.core.result import RunResult, Segment
from reports import quantities
from reports.comparison import overlay
from reports.drawings import Drawing
from reports.labels import Label
from reports.origin import Origin
from reports.outputs.tuning import verdict
from reports.parts import Cell, Map, Page, Part, Table

_LEADS = "Each margin on the car that is worst for it, weighted; in brackets: on the model itself."

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
    files: Mapping[str, bytes],
    title: str,
    origin: Origin,
    confirmed: Confirmation | None = None,
) -> Page:
    """The page; `files` hold the figures that are drawn already, `confirmed` what a run came to."""
    worst = found.chosen.worst
    notes = ["The search was interrupted: this is what was best then."] if found.ended == "stopped" else []
    return Page(
        kind="Tuning",
        title=title,
        headline=f"Worst margin {quantities.share(worst.worst)}",
        tone="pass" if worst.worst >= 0 else "fail",
        lead=verdict(found),
        notes=tuple(notes),
        parts=(*_confirmed(confirmed), *_parts(found, runs, files, origin)),
        mark=origin.mark,
    )


def _parts(found: Tuning, runs: Sequence[Shown], files: Mapping[str, bytes], origin: Origin) -> list[Part]:
    parts = [
        Part("margins", "Margins", _margins_text(found), (_margins(found),)),
        Part("limits", "Hard limits", _limits_text(found), (_limits(found),)),
        Part("parameters", "Parameters", "", (_parameters(found),)),
        Part("binding", "What binds", _binding_text(found), (_binding(found),)),
    ]
    if "front.svg" in files:
        words = "Peak against band energy and against the largest sensitivity, of every candidate."
        parts.append(
            Part(
                "front",
                "What can be traded",
                "Grey: candidates within the hard limits, on the model itself. Light blue: those that no "
                "other beats in all three figures, each the largest over the driven segments.",
                figures=(Drawing(Label("Front"), files["front.svg"], words),),
            )
        )
    if found.sensitivities:
        parts.append(
            Part(
                "sensitivities",
                "Sensitivities",
                "Change of a margin, in points of percent, when a parameter moves by a tenth of its range; "
                "on the model itself.",
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
            f"{found.runs} predicted runs of the plan; {found.ended}. From the start and the best of points "
            "all over the space uphill on the model itself, by linear programmes on the slopes of all "
            "margins and hard limits; then on a growing set of cars.",
        )
    )
    return [*parts, origin.part]


def _confirmed(found: Confirmation | None) -> tuple[Part, ...]:
    """Predicted and measured side by side, if it was run."""
    if found is None:
        return ()
    rows = tuple(
        (
            one.id.replace(".", " "),
            quantities.number(one.predicted.value),
            quantities.number(one.measured.value),
            quantities.number(one.difference, significant=3),
            quantities.unit(one.unit),
            quantities.share(one.apart, 2) if one.of_limit else quantities.DASH,
            one.measured.verdict,
        )
        for one in found.criteria
    )
    words = "as predicted" if found.agrees else "not as predicted: see the diagnosis"
    allowed = quantities.share(found.allowed)
    text = (
        f"The plan run with the tuned controller, over the wire. Allowed: {allowed} of a limit, of the "
        f"larger value where there is none; {words}."
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
        (criterion.id.replace(".", " "), *(_margin(one, criterion.id) for one in found.shown))
        for criterion in found.trial.driven.criteria
    ]
    rows.append(("worst", *(_worst(one, found) for one in found.shown)))
    return Table(("criterion", *names), tuple(rows))


def _worst(one: Standing, found: Tuning) -> str:
    if not one.worst.feasible:
        return "none"
    return quantities.share(min(one.least_margin(criterion.id) for criterion in found.trial.driven.criteria))


def _margin(one: Standing, id_: str) -> str:
    least = quantities.share(one.least_margin(id_)) if all(t.margins for t in one.tried) else quantities.DASH
    if len(one.tried) == 1:
        return least
    own = one.nominal.margins.get(id_)
    return f"{least} ({quantities.share(own)})"


def _limits_text(found: Tuning) -> str:
    count = len(found.trial.draws)
    cars = "the model itself" if count == 1 else f"the model and {count - 1} cars drawn around it"
    return f"Least room over {cars}, a share of the limit. Stability margins are of the sampled loop."


def _limits(found: Tuning) -> Table:
    names = tuple(one.name for one in found.shown)
    rows = []
    for name in found.chosen.nominal.limits:
        cells = (
            quantities.share(min(t.limits.get(name, float("nan")) for t in one.tried)) for one in found.shown
        )
        limit = getattr(found.trial.free.limits, name)
        value = "yes" if isinstance(limit, bool) else quantities.nominal(limit)
        rows.append((_LIMITS.get(name, name.replace("_", " ")), value, *cells))
    return Table(("limit", "value", *names), tuple(rows))


def _parameters(found: Tuning) -> Table:
    own = values_of(found.trial.start)
    rows = [
        (
            PARAMETERS[name].words,
            quantities.number(value),
            quantities.number(own[name]),
            *(quantities.nominal(bound) for bound in found.trial.free.free[name]),
            quantities.unit(PARAMETERS[name].unit),
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
    told = "The cars with the least margins and the criterion that binds each."
    return f"{told} At a bound: {', '.join(at_bound)}; wider bounds may give more." if at_bound else told


def _binding(found: Tuning) -> Table:
    rows = []
    for tried in sorted(found.chosen.tried, key=lambda one: one.worst)[:5]:
        differs = found.trial.draws[tried.draw].differs
        words = ", ".join(f"{name} {quantities.number(value)}" for name, value in differs.items())
        car = "the model itself" if tried.draw == 0 else f"draw\u00a0{tried.draw}"
        rows.append((car, quantities.share(tried.worst), tried.binding.replace(".", " "), words))
    return Table(("car", "worst margin", "binding criterion", "differs"), tuple(rows), 1, 2)


def _sensitivities(found: Tuning) -> Map:
    largest = max(
        (abs(v) for row in found.sensitivities.values() for v in row.values() if np.isfinite(v)), default=1.0
    )
    rows = tuple(
        (
            criterion.replace(".", " "),
            tuple(
                Cell(
                    quantities.number(10 * value, 1),
                    min(1.0, abs(value) / largest) if np.isfinite(value) else 0.0,
                )
                for value in row.values()
            ),
        )
        for criterion, row in found.sensitivities.items()
    )
    return Map("", ("criterion", *(PARAMETERS[name].symbol for name in found.space.names)), rows)
