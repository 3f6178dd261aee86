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
    """Names and line styles: one colour for each step on a road with a controller, one dash for each repeat.

    Where a controller drove several, each is named by its segment; the controller's name stands beside it
    where there are several controllers.
    """
    further = iter(style.FURTHER_ROLES * len(segments))
    drivers = [controller_of(segment) or segment.id for segment in segments]
    roles: dict[tuple[str, float, float, float | None], str] = {}
    uses: dict[str, int] = {}
    found = []
    for segment, driver in zip(segments, drivers, strict=True):
        alike = driver, segment.reference_before, segment.reference_after, segment.friction
        if alike not in roles:
            own = segment.controller if driver == controller_name(segment.controller) else ""
            free = own in ("gain", "phase") and own not in roles.values()
            roles[alike] = own if free else next(further)
        role = roles[alike]
        uses[role] = uses.get(role, -1) + 1
        name = _shortened(driver)
        if drivers.count(driver) > 1:
            alone = len(set(drivers)) == 1
            name = _shortened(segment.id) if alone else f"{name} ({_shortened(segment.id)})"
        road = road_in_words(segment)
        name += f", {road}" if road else ""
        found.append(Member(segment, name, role, style.DASHES[uses[role] % len(style.DASHES)]))
    return found


def controller_of(segment: Segment) -> str:
    """Name of the controller that drove a segment: of its file, else of its kind; '' without one."""
    return controller_name(segment.controller_name or segment.controller)


def road_in_words(segment: Segment) -> str:
    """The road as it was set; '' where it never was."""
    if segment.friction is None:
        return ""
    return f"friction {segment.friction:g} of a dry road's" if segment.slippery else "dry road"


def controller_name(controller: str) -> str:
    """'gain' and 'phase' in full; another controller's own name."""
    return f"{controller.capitalize()} stabilization" if controller in ("gain", "phase") else controller


def _shortened(name: str) -> str:
    return name if len(name) <= _LONGEST_NAME else f"{name[: _LONGEST_NAME - 1]}…"
