"""Which figures a report has, from whatever segments and channels there are."""

from __future__ import annotations

import re
from dataclasses import replace

from hil.core.recording import Recording
from hil.core.result import RunResult, Segment
from reports.channel_figures import channels_section, further_section, overview_section, sweep_section
from reports.drive_figures import drive_section
from reports.figure import Section
from reports.order_figures import order_section
from reports.step_figures import step_section
from reports.stretch import thinned


def sections(recording: Recording, result: RunResult | None) -> list[Section]:
    """Steps by initial speed, other segments, orders, the whole run, further channels; else all channels."""
    whole = thinned(recording)
    if result is None or not result.segments:
        return _anchored([_filled(channels_section(recording, whole))])
    criteria = {criterion.id: criterion for criterion in result.criteria}
    steps: dict[float, list[Segment]] = {}
    for segment in result.segments:
        if segment.kind == "step":
            steps.setdefault(segment.initial_speed_km_h, []).append(segment)
    found = [section for section in [drive_section(recording, result.segments, criteria)] if section]
    found += [step_section(recording, group, criteria) for group in steps.values()]
    found += [sweep_section(recording, s) for s in result.segments if s.kind != "step"]
    orders = order_section(recording, result.segments)
    found += [orders] if orders is not None else []
    of_all = [section(recording, whole, result.segments) for section in (overview_section, further_section)]
    found += [section for section in of_all if section]
    return _anchored([_filled(section) for section in found])


def _filled(section: Section) -> Section:
    """Figures stand in pairs; one that is left over takes the whole width."""
    if len(section.figures) % 2 == 0:
        return section
    return replace(section, figures=(*section.figures[:-1], replace(section.figures[-1], wide=True)))


def _anchored(found: list[Section]) -> list[Section]:
    """Ids made of letters, digits, '.', '-' and '_', each used once, whatever a plan calls its segments."""
    used: set[str] = set()

    def anchor(text: str) -> str:
        slug = re.sub(r"[^A-Za-z0-9._-]+", "-", text)
        number = 1
        while (free := slug if number == 1 else f"{slug}-{number}") in used:
            number += 1
        used.add(free)
        return free

    return [
        replace(
            section,
            id=anchor(section.id),
            figures=tuple(replace(figure, id=anchor(figure.id)) for figure in section.figures),
        )
        for section in found
    ]
