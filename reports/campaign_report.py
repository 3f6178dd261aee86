"""The report of `hil campaign`: shares that pass, distributions, worst cases, what decides."""

from __future__ import annotations

import math
from collections.abc import Mapping

from hil.analysis.campaigns import CONFIDENCE, Findings, OfController, OfCriterion
from reports import drawings, labels
from reports.drawings import Drawing
from reports.labels import Label, criterion_title
from reports.origin import Origin
from reports.outputs.campaign import name_of, passed, share_in_words
from reports.parts import Cell, Map, Page, Part, Table

_TROUBLES = 20
_ROWS = 12  # of the first screen
_INPUTS_SHOWN = 6  # of a worst case: those that its binding criterion hangs on most


def campaign_page(
    found: Findings, title: str, description: str, origin: Origin, *, random: bool, wanted: float | None
) -> Page:
    """The page.

    Args:
        random: whether cars are drawn: only then a share has an interval.
        wanted: share that is to pass; None: nothing is.
    """
    reached = passed(found, wanted)
    drawn = _distributions(found)
    return Page(
        kind="Campaign",
        title=title,
        headline=f"{labels.share(found.least_share)} passed",
        tone="quiet" if reached is None else "pass" if reached else "fail",
        lead=_lead(found, wanted),
        notes=(description.strip(),) if description.strip() else (),
        parts=(*_parts(found, drawn, random=random), origin.part),
        mark=origin.mark,
        first=_first(found, drawn),
    )


def _lead(found: Findings, wanted: float | None) -> str:
    count = f"{found.simulations} simulations of the plan"
    several = ", with each controller" if len(found.controllers) > 1 else ""
    if wanted is None:
        return f"{count}{several}. No required pass rate was specified."
    reached = "reached" if passed(found, wanted) else "not reached"
    return f"{count}{several}. Required pass rate {labels.share(wanted)}: {reached}."


def _parts(found: Findings, drawn: Mapping[str, Drawing], *, random: bool) -> list[Part]:
    interval = f" The interval holds the true share with {CONFIDENCE:.0%} (Clopper and Pearson)."
    words = "A simulation passes if each of its criteria does; one that could not be executed does not."
    parts = [
        Part("shares", "Pass rates", words + interval * random, (_shares(found, random),)),
        Part(
            "criteria",
            "Criteria",
            "Shares of the simulations that were executed; quantiles of the values.",
            tuple(_criteria(one, found) for one in found.controllers),
        ),
        Part("distributions", "Distributions", "", figures=tuple(drawn.values())),
    ]
    if found.inputs:
        words = (
            "Rank correlation (Spearman's ρ) of each criterion's value with each input. 1: both "
            f"rise together (red), {labels.MINUS}1: one falls as the other rises (blue), 0: unrelated."
        )
        maps = tuple(_correlations(one, found) for one in found.controllers)
        parts.append(Part("sensitivities", "What the criteria depend on", words, maps=maps))
    if any(one.worst for one in found.controllers):
        words = "The least margins, and the inputs with the largest influence on the binding criterion."
        tables = tuple(_worst(one, found) for one in found.controllers if one.worst)
        parts.append(Part("worst", "Worst cases", words, tables))
    if found.errors:
        rows = tuple((str(count), why) for why, count in list(found.errors.items())[:_TROUBLES])
        table = Table(("count", "reason"), rows, 0, 1)
        parts.append(Part("errors", "Could not be simulated", "Each reason once, with its count.", (table,)))
    return parts


def _first(found: Findings, drawn: Mapping[str, Drawing]) -> Part | None:
    """Criteria with a limit, the lowest pass rate and the least median margin first; the first one drawn."""
    limited = [(one, c) for one in found.controllers for c in one.criteria if c.limited]
    if not limited:
        return None
    ranked = sorted(limited, key=lambda found: (found[1].share.value, _median_margin(found[1])))
    rows = tuple(
        (
            criterion_title(criterion.id),
            name_of(one),
            labels.share(criterion.share.value),
            *(labels.number(criterion.quantile(share)) for share in (0.5, 0.99)),
            f"{_limit(criterion)} {labels.unit(criterion.unit)}".strip(),
        )
        for one, criterion in ranked[:_ROWS]
    )
    table = Table(("criterion", "controller", "passed", "median", "99 %", "limit"), rows, 2)
    figure = next((drawn[c.id] for _, c in ranked if c.id in drawn), None)
    left = len(ranked) - len(rows)
    text = f"{left} further criteria are in the table of all." if left > 0 else ""
    return Part("summary", "Criteria by pass rate", text, (table,), figures=(figure,) if figure else ())


def _median_margin(criterion: OfCriterion) -> float:
    """Of the median, as a share of the nearest limit; infinite without a limit in numbers."""
    middle = criterion.quantile(0.5)
    room = [(criterion.upper, 1.0), (criterion.lower, -1.0)]
    shares = [turn * (limit - middle) / abs(limit) for limit, turn in room if limit and middle is not None]
    return min(shares, default=math.inf)


def _shares(found: Findings, random: bool) -> Table:
    rows = tuple(
        (name_of(one), share_in_words(one.share, random=random), str(one.errors)) for one in found.controllers
    )
    return Table(("controller", "pass", "could not be simulated"), rows, numbers_from=9)


def _criteria(one: OfController, found: Findings) -> Table:
    head = ("criterion" if len(found.controllers) == 1 else name_of(one), "pass", "limit")
    rows = tuple(
        (
            criterion_title(criterion.id),
            labels.share(criterion.share.value) if criterion.limited else labels.DASH,
            _limit(criterion),
            *(labels.number(criterion.quantile(share)) for share in (0.01, 0.5, 0.99)),
            labels.unit(criterion.unit),
        )
        for criterion in one.criteria
    )
    return Table((*head, "1 %", "median", "99 %", "unit"), rows, 1, 6)


def _limit(one: OfCriterion) -> str:
    if one.below:
        return f"< {one.below}"
    bounds = [f"≥ {labels.nominal(one.lower)}"] if one.lower is not None else []
    bounds += [f"≤ {labels.nominal(one.upper)}"] if one.upper is not None else []
    return " ".join(bounds) or labels.DASH


def _distributions(found: Findings) -> dict[str, Drawing]:
    """By the criterion's id."""
    drawn: dict[str, Drawing] = {}
    for number, first in enumerate(found.controllers[0].criteria if found.controllers else ()):
        if first.below:
            continue
        each = {one.name: one.criteria[number] for one in found.controllers}
        if not any(criterion.values.size for criterion in each.values()):
            continue
        limits = tuple(limit for limit in (first.lower, first.upper) if limit is not None)
        label = f"{criterion_title(first.id).partition(', ')[0]} in {first.unit}"
        figure = drawings.distribution(label, {name: one.values for name, one in each.items()}, limits)
        title = Label(first.title or criterion_title(first.id))
        drawn[first.id] = Drawing(title, drawings.render(figure)["svg"], _in_words(first, each), wide=False)
    return drawn


def _in_words(first: OfCriterion, each: dict[str, OfCriterion]) -> str:
    """For who cannot see the histogram."""
    lines = [f"Histogram of {first.id} in {first.unit}."]
    for name, one in each.items():
        low, middle, high = (labels.number(one.quantile(share)) for share in (0.0, 0.5, 1.0))
        lines.append(f"{name or 'Values'}: from {low} to {high}, median {middle}.")
    if first.upper is not None:
        lines.append(f"At most {labels.nominal(first.upper)}.")
    if first.lower is not None:
        lines.append(f"At least {labels.nominal(first.lower)}.")
    return " ".join(lines)


def _correlations(one: OfController, found: Findings) -> Map:
    rows = tuple(
        (
            criterion_title(criterion.id),
            tuple(_cell(criterion.correlations.get(name, math.nan)) for name in found.inputs),
        )
        for criterion in one.criteria
        if not criterion.below and criterion.values.size
    )
    title = name_of(one) if len(found.controllers) > 1 else ""
    return Map(title, ("criterion", *(_short(name) for name in found.inputs)), rows)


def _cell(value: float) -> Cell:
    return Cell(labels.number(value, 2), 0.0 if math.isnan(value) else min(1.0, abs(value)), value < 0)


def _short(column: str) -> str:
    """An input as the head of a column: without its group."""
    return column.partition(".")[2].replace("_", " ").replace(".", " ")


def _worst(one: OfController, found: Findings) -> Table:
    criteria = {criterion.id: criterion for criterion in one.criteria}
    rows = []
    for case in one.worst:
        known = criteria[case.binding].correlations
        order = sorted(case.inputs, key=lambda name: -abs(_or_zero(known.get(name, 0.0))))
        words = ", ".join(
            f"{_short(name)} {labels.quantity(case.inputs[name], found.inputs[name])}"
            for name in order[:_INPUTS_SHOWN]
        )
        rows.append(
            (
                str(case.simulation),
                labels.share(case.margin),
                criterion_title(case.binding),
                words or labels.DASH,
            )
        )
    return Table(("simulation", "margin", "binding criterion", "inputs"), tuple(rows), 0, 2)


def _or_zero(value: float) -> float:
    return 0.0 if math.isnan(value) else value
