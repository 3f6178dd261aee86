"""Where a diagnosis looks first: an effect near a few sizes, in the scene that recordings set."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, Protocol

Values = dict[str, float | str]

#: How far a response may be stretched to stand for a neighbouring size.
STRETCH = (0.5, 1.6)


@dataclass(frozen=True)
class Direction:
    """The plant with an effect of some size, and how many of these may be added linearly."""

    values: Values
    lower: float = 1.0
    upper: float = 1.0


@dataclass(frozen=True)
class Probe:
    """An effect near one size: its response is Σ αᵢ·directionᵢ; `start` makes values from the αs.

    One that is not `first` is looked at only where the most promising of those that are stands at its
    `place` among sizes, or next to it.
    """

    directions: tuple[Direction, ...]
    start: Callable[[Sequence[float]], Values]
    place: int = 0
    first: bool = True

    def at(self, place: int, *, first: bool) -> Probe:
        """The same, standing there."""
        return replace(self, place=place, first=first)


class Scene(Protocol):
    """What the sizes of probes are taken from."""

    @property
    def torque_nm(self) -> float:
        """Largest requested torque, rotor side."""

    @property
    def power_w(self) -> float:
        """Largest power that a request asks of the motor at its speed; 0 where no speed is known."""

    @property
    def shaft_torque_nm(self) -> float:
        """Largest shaft torque, by the model where it was not measured."""

    @property
    def parameters(self) -> Mapping[str, float]:
        """Linear numbers (names of `Chain`) of the model with what was found so far."""

    @property
    def channels(self) -> tuple[str, ...]:
        """Those that were measured."""

    def orders(self, side: Literal["wheel", "rotor"]) -> list[float]:
        """Orders of turning that stand out in what the model leaves unexplained, strongest first."""


Probes = Callable[[Scene], Iterator[Probe]]


def around(rest: float, name: str, unit: float, lower: float, upper: float, **others: float | str) -> Probe:
    """An effect that is linear in `name`, around `rest`, where it does nothing."""
    direction = Direction({**others, name: rest + unit}, lower, upper)
    return Probe((direction,), lambda a: {**others, name: rest + float(a[0]) * unit})


def scaled(name: str, unit: float, lower: float, upper: float, **others: float | str) -> Probe:
    """An effect that is linear in `name`, around zero."""
    return around(0.0, name, unit, lower, upper, **others)


def fixed(**values: Any) -> Probe:
    """An effect of one size; neighbouring sizes look alike, whatever their numbers are."""
    return Probe((Direction(dict(values), *STRETCH),), lambda _: dict(values))


def sized(name: str, size: float, lower: float = STRETCH[0], **others: float | str) -> Probe:
    """An effect whose response goes about with its one number near `size`."""
    return scaled(name, size, lower, STRETCH[1], **others)


def clipped(name: str, most: float) -> Iterator[Probe]:
    """Limits of something that reaches `most`; a response goes about with what a limit cuts off."""
    for share in (0.97, 0.92, 0.85, 0.75, 0.65, 0.55, 0.45, 0.35, 0.25):
        yield Probe(
            (Direction({name: share * most}, *STRETCH),),
            lambda a, share=share: {name: max(1.0 - float(a[0]) * (1.0 - share), 0.05) * most},  # type: ignore[misc]
        )


def ripple(order: float, unit: float) -> Probe:
    """A torque of `unit` N m that follows an angle, of any phase."""
    sine: Values = {"order": order, "amplitude_nm": unit, "phase_rad": 0.0}
    cosine: Values = {"order": order, "amplitude_nm": unit, "phase_rad": 0.5 * math.pi}

    def start(a: Sequence[float]) -> Values:
        amplitude = max(math.hypot(a[0], a[1]), 1e-3) * unit
        return {"order": order, "amplitude_nm": amplitude, "phase_rad": math.atan2(a[1], a[0])}

    return Probe((Direction(sine, -1e4, 1e4), Direction(cosine, -1e4, 1e4)), start)


def reading(channel: str, name: str, rest: float, unit: float, lower: float, upper: float) -> Probe:
    """A sensor effect of one channel, linear around a true reading, which is at `rest`."""
    return around(rest, name, unit, lower, upper, channel=channel)
