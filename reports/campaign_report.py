"""The report of `hil campaign`: shares that pass, distributions, worst cases, what decides."""

from __future__ import annotations

import math

from hil.analysis.campaigns import CONFIDENCE, Findings, OfController, OfCriterion
from reports import drawings, quantities
from reports.drawings import Drawing
from reports.labels import Label
from reports.origin import Origin
from reports.outputs.campaign import name_of, passed, share_in_words
from reports.parts import Cell, Map, Page, Part, Table

_TROUBLES = 20
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
    return Page(
        kind="Campaign",
        title=title,
        headline=f"{quantities.share(found.least_share)} pass",
        tone="quiet" if reached is None else "pass" if reached else "fail",
        lead=_lead(found, wanted),
        notes=(description.strip(),) if description.strip() else (),
        parts=(*_parts(found, random), origin.part),
        mark=origin.mark,
    )


def _lead(found: Findings, wanted: float | None) -> str:
    count = f"{found.simulations} simulations of the plan"
    several = ", with each controller" if len(found.controllers) > 1 else ""
    if wanted is None:
        return f"{count}{several}. No share was asked for."
    reached = "reached" if passed(found, wanted) else "not reached"
    return f"{count}{several}. At least {quantities.share(wanted)} were to pass: {reached}."


def _parts(found: Findings, random: bool) -> list[Part]:
    interval = f" The interval holds the true share with {CONFIDENCE:.0%} (Clopper and Pearson)."
    words = "A simulation passes if each of its criteria does; one that could not be carried out does not."
    parts = [
        Part("shares", "How often it passes", words + interval * random, (_shares(found, random),)),
        Part(
            "criteria",
            "Criteria",
            "Shares of the simulations that were carried out; quantiles of the values.",
            tuple(_criteria(one, found) for one in found.controllers),
        ),
        Part("distributions", "Distributions", "", figures=tuple(_distributions(found))),
    ]
    if found.inputs:
        words = (
            "Rank correlation (Spearman's ρ) of each criterion's value with what was varied or drawn: 1 and "
            f"{quantities.MINUS}1 where the order of one is that of the other, 0 where they are unrelated."
        )
        maps = tuple(_correlations(one, found) for one in found.controllers)
        parts.append(Part("sensitivities", "What decides", words, maps=maps))
    if any(one.worst for one in found.controllers):
        words = "The least margins to a limit, and the inputs that the binding criterion hangs on most."
        tables = tuple(_worst(one, found) for one in found.controllers if one.worst)
        parts.append(Part("worst", "Worst cases", words, tables))
    if found.errors:
        rows = tuple((str(count), why) for why, count in list(found.errors.items())[:_TROUBLES])
        table = Table(("how often", "why"), rows, 0, 1)
        parts.append(Part("errors", "Could not be simulated", "Each kind of trouble once.", (table,)))
    return parts


def _shares(found: Findings, random: bool) -> Table:
    rows = tuple(
        (name_of(one), share_in_words(one.share, random=random), str(one.errors)) for one in found.controllers
    )
    return Table(("controller", "pass", "could not be simulated"), rows, numbers_from=9)


def _criteria(one: OfController, found: Findings) -> Table:
    head = ("criterion" if len(found.controllers) == 1 else name_of(one), "pass", "limit")
    rows = tuple(
        (
            criterion.id.replace(".", " "),
            quantities.share(criterion.share.value) if criterion.limited else quantities.DASH,
            _limit(criterion),
            *(quantities.number(criterion.quantile(share)) for share in (0.01, 0.5, 0.99)),
            quantities.unit(criterion.unit),
        )
        for criterion in one.criteria
    )
    return Table((*head, "1 %", "median", "99 %", "unit"), rows, 1, 6)


def _limit(one: OfCriterion) -> str:
    if one.below:
        return f"< {one.below}"
    bounds = [f"≥ {quantities.nominal(one.lower)}"] if one.lower is not None else []
    bounds += [f"≤ {quantities.nominal(one.upper)}"] if one.upper is not None else []
    return " ".join(bounds) or quantities.DASH


def _distributions(found: Findings) -> list[Drawing]:
    drawn: list[Drawing] = []
    for number, first in enumerate(found.controllers[0].criteria if found.controllers else ()):
        if first.below:
            continue
        each = {one.name: one.criteria[number] for one in found.controllers}
        if not any(criterion.values.size for criterion in each.values()):
            continue
        limits = tuple(limit for limit in (first.lower, first.upper) if limit is not None)
        label = f"{first.id.replace('.', ' ').replace('_', ' ')} in {first.unit}"
        figure = drawings.distribution(label, {name: one.values for name, one in each.items()}, limits)
        title = Label(first.title or first.id.replace(".", " ").replace("_", " "))
        drawn.append(Drawing(title, drawings.render(figure)["svg"], _in_words(first, each), wide=False))
    return drawn


def _in_words(first: OfCriterion, each: dict[str, OfCriterion]) -> str:
    """For who cannot see the histogram."""
    told = [f"Histogram of {first.id} in {first.unit}."]
    for name, one in each.items():
        low, middle, high = (quantities.number(one.quantile(share)) for share in (0.0, 0.5, 1.0))
        told.append(f"{name or 'Values'}: from {low} to {high}, median {middle}.")
    if first.upper is not None:
        told.append(f"At most {quantities.nominal(first.upper)}.")
    if first.lower is not None:
        told.append(f"At least {quantities.nominal(first.lower)}.")
    return " ".join(told)


def _correlations(one: OfController, found: Findings) -> Map:
    rows = tuple(
        (
            criterion.id.replace(".", " "),
            tuple(_cell(criterion.correlations.get(name, math.nan)) for name in found.inputs),
        )
        for criterion in one.criteria
        if not criterion.below and criterion.values.size
    )
    title = name_of(one) if len(found.controllers) > 1 else ""
    return Map(title, ("criterion", *(_short(name) for name in found.inputs)), rows)


def _cell(value: float) -> Cell:
    return Cell(quantities.number(value, 2), 0.0 if math.isnan(value) else min(1.0, abs(value)))


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
            f"{_short(name)} {quantities.quantity(case.inputs[name], found.inputs[name])}"
            for name in order[:_INPUTS_SHOWN]
        )
        rows.append(
            (
                str(case.simulation),
                quantities.share(case.margin),
                case.binding.replace(".", " "),
                words or quantities.DASH,
            )
        )
    return Table(("simulation", "margin", "binding criterion", "inputs"), tuple(rows), 0, 2)


def _or_zero(value: float) -> float:
    return 0.0 if math.isnan(value) else value
