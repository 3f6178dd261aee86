"""Segments laid over each other: the name, colour and dash of each."""

from __future__ import annotations

from dataclasses import dataclass

from hil.core.result import Segment
from reports import style

_LONGEST_NAME = 26


@dataclass(frozen=True)
class Member:
    """One segment of an overlay with its name and line style."""

    segment: Segment
    name: str
    role: str
    dash: str


def members(segments: list[Segment]) -> list[Member]:
    """Names and line styles: one colour for each controller, one dash for each repeat of it."""
    further = iter(style.FURTHER_ROLES * len(segments))
    roles: dict[str, str] = {}
    uses: dict[str, int] = {}
    found = []
    for segment in segments:
        controller = segment.controller or segment.id
        if controller not in roles:
            roles[controller] = controller if controller in ("gain", "phase") else next(further)
        repeat = uses[controller] = uses.get(controller, -1) + 1
        name = _shortened(controller_name(controller))
        name = f"{name} ({_shortened(segment.id)})" if repeat else name
        found.append(Member(segment, name, roles[controller], style.DASHES[repeat % len(style.DASHES)]))
    return found


def controller_name(controller: str) -> str:
    """'gain' and 'phase' in full; another controller's own name."""
    return f"{controller.capitalize()} stabilization" if controller in ("gain", "phase") else controller


def _shortened(name: str) -> str:
    return name if len(name) <= _LONGEST_NAME else f"{name[: _LONGEST_NAME - 1]}…"
