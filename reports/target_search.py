"""The report of `hil explain`: ranked rivals, conditions that they hold, responses beside the targets."""

from __future__ import annotations

from dataclasses import replace

from hil.analysis.target_search import Condition, Explanation, Rival
from hil.core.effects import EFFECTS
from hil.core.result import Segment
from reports import labels
from reports.figure import Figure, Level
from reports.labels import Label, channel_label, channel_unit, criterion_title, with_titles
from reports.parts import Page, Part, Table, page_html, page_pdf
from reports.step_figures import FIRST_SECONDS
from reports.stretch import line

_ROLES = ("reference", "gain", "phase", "third", "fourth")
_DRAWN = 3
_PEAK = "peak_shaft_torque"
_SHAFT_TORQUE = "shaft_torque_nm"


def explanation_html(found: Explanation) -> str:
    """The page: one file with interactive figures."""
    return page_html(_page(found))


def explanation_pdf(found: Explanation) -> bytes:
    """The same on paper: PDF/A-2a and PDF/UA-1."""
    return page_pdf(_page(found))


def caution(found: Explanation) -> str:
    """What the figures cannot say, in words."""
    count = len(found.targets.values)
    best = found.rivals[0].numbers if found.rivals else 0
    are, them = ("does", "it") if count == 1 else ("do", "them")
    text = (
        f"{_several(count, 'figure')} {are} not single out a cause: the best rival has "
        f"{_several(best, 'free number')} for {them}, and "
        "what is ranked here is what could be, not what is. Only a recording decides (hil diagnose)."
    )
    if found.separating is not None:
        text += (
            f" The run that separates the first two: {found.separating.words}; they differ there by "
            f"{with_titles(found.separating.in_words())}."
        )
    return text


def _several(count: int, what: str) -> str:
    return f"{count} {what}{'' if count == 1 else 's'}"


def _page(found: Explanation) -> Page:
    notes = ["The search was interrupted: this is what was known then."] if found.interrupted else []
    return Page(
        kind="Model changes that reproduce target values",
        title=f"{found.targets.plan.name}: model changes for the target values",
        headline="Reached" if found.reached else "Not reached",
        tone="pass" if found.reached else "error",
        lead=found.verdict,
        notes=(caution(found), *notes),
        parts=tuple(_parts(found)),
        first=_first(found),
    )


def _first(found: Explanation) -> Part:
    """What each candidate reaches of the target values, and the first response beside its target."""
    figures = tuple(replace(figure, wide=True) for figure in _figures(found)[:1])
    text = f"Values beside the targets. Figure: shaft torque of the first {FIRST_SECONDS:g} s."
    return Part("rivals", "Candidates", text, (_rivals(found),), figures=figures)


def _parts(found: Explanation) -> list[Part]:
    return [
        Part(
            "responses",
            "Responses beside the targets",
            f"Shaft torque of the first {FIRST_SECONDS:g} s. Dashed: the target.",
            figures=_figures(found),
        ),
        *(
            Part(
                f"conditions-{number}",
                f"Conditions, candidate {number}: {rival.name}",
                _values(rival),
                (_conditions(rival.conditions),),
            )
            for number, rival in enumerate(found.rivals[:2], 1)
        ),
        Part("base", "Conditions, the model as it came", "", (_conditions(found.base.conditions),)),
        Part(
            "search",
            "What was searched",
            f"{found.evaluations} guesses, each a whole run on the predicted bench: "
            f"{', '.join(found.searched)}, alone and in pairs, within the sizes that the effects declare.",
        ),
    ]


def _rivals(found: Explanation) -> Table:
    names = tuple(found.targets.values)
    rows = [("target", *(labels.number(v, significant=4) for v in found.targets.values.values()), "", "")]
    for name, rival in (("the model as it came", found.base), *((r.name, r) for r in found.rivals)):
        figures = (labels.number(rival.outcome.figures[n], significant=4) for n in names)
        missed = f"{len(rival.missed)} of {len(rival.conditions)}"
        rows.append((name, *figures, str(rival.numbers), missed))
    heads = map(criterion_title, names)
    return Table(("", *heads, "free numbers", "conditions missed"), tuple(rows))


def _values(rival: Rival) -> str:
    """The numbers of a rival in a sentence."""
    lines = []
    for id_, values in rival.guess.effects.items():
        units = {p.name: p.unit for p in EFFECTS[id_].parameters}
        numbers = ", ".join(f"{n} {labels.quantity(v, units[n])}" for n, v in values.items())
        lines.append(f"{EFFECTS[id_].title}: {numbers}.")
    if rival.guess.held:
        numbers = ", ".join(f"{n} {labels.number(v)}" for n, v in rival.guess.held.items())
        lines.append(f"The RMCU keeps {numbers}, whatever is written to it.")
    return " ".join(lines)


def _conditions(conditions: tuple[Condition, ...]) -> Table:
    rows = [
        (c.name, labels.number(c.found), c.limit, c.unit, "holds" if c.holds else "missed")
        for c in conditions
    ]
    return Table(("condition", "found", "wanted", "unit", ""), tuple(rows), 1, 2)


def _figures(found: Explanation) -> tuple[Figure, ...]:
    figures = []
    for name, wanted in found.targets.values.items():
        segment, _, metric = name.partition(".")
        if metric == _PEAK:
            figures.append(_figure(found, segment, wanted))
    return tuple(figure for figure in figures if figure is not None)


def _figure(found: Explanation, segment: str, wanted: float) -> Figure | None:
    shown = [("the model as it came", found.base), *((r.name, r) for r in found.rivals[:_DRAWN])]
    traces = []
    for (name, rival), role in zip(shown, _ROLES, strict=False):
        prediction = rival.outcome.prediction
        own = _segment(rival, segment)
        if prediction is None or own is None:
            continue
        trace = line(
            prediction.recording,
            _SHAFT_TORQUE,
            Label(name),
            role,
            start_s=own.step_s - 0.1,
            end_s=min(own.end_s, own.step_s + FIRST_SECONDS),
            zero_s=own.step_s,
        )
        traces += [trace] if trace else []
    if not traces:
        return None
    label = channel_label(_SHAFT_TORQUE)
    highest = max(float(trace.y.max()) for trace in traces)
    lowest = min(float(trace.y.min()) for trace in traces)
    return Figure(
        segment,
        Label(segment, "", f": {label.text.lower()}, target {labels.nominal(wanted, 'N m')}"),
        "Time from the step",
        "s",
        label,
        channel_unit(_SHAFT_TORQUE),
        tuple(traces),
        levels=(Level(wanted, f"Target {labels.nominal(wanted, 'N m')}, {segment}"),),
        x_range=(-0.1, FIRST_SECONDS),
        y_range=(min(0.0, 1.05 * lowest), 1.1 * max(highest, wanted)),
    )


def _segment(rival: Rival, id_: str) -> Segment | None:
    prediction = rival.outcome.prediction
    return next((s for s in prediction.segments if s.id == id_), None) if prediction else None
