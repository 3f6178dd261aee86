"""How large an effect may plausibly be: the one place where that is decided, from its own declaration.

The range of a number is what the effect's probes span, the sizes that a diagnosis tries on such an axle, and
where an optional number has sizes that it is opened with, those. A ripple has no largest size of its own: its
amplitude is at most `LARGEST_RIPPLE` of the torque on its side, its order within `ORDERS`. Bounds of the
declaration (`lower`, `upper`, `within`) are never left.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from hil.core.channels import OUTPUTS
from hil.core.effects import EFFECTS, Effect, Parameter, Probe, Stage
from hil.core.model import Model
from hil.plant import chain_numbers

LARGEST_RIPPLE = 1 / 3
_LEAST_RIPPLE = 0.01
ORDERS = {"wheel": (1.0, 6.0), "rotor": (0.3, 12.0)}
_UNBOUNDED = 1e3  # a direction that may be added more often than this has no size of its own
_LOGARITHMIC = 5.0  # ranges of a larger ratio are searched by their logarithm
_OUT_OF_PLACE = (Stage.SENSOR, Stage.MODEL)


@dataclass(frozen=True)
class Scene:
    """What probes take their sizes from: torques in N m, the model's linear numbers."""

    torque_nm: float
    shaft_torque_nm: float
    parameters: Mapping[str, float]
    channels: tuple[str, ...] = OUTPUTS
    power_w: float = 0.0  # at no known speed

    def orders(self, side: Literal["wheel", "rotor"]) -> list[float]:
        """The ends of the orders that are looked at."""
        return list(ORDERS[side])


@dataclass(frozen=True)
class Number:
    """One number to be searched for, from `low` to `high`."""

    name: str
    unit: str
    low: float
    high: float

    def at(self, share: float) -> float:
        """The value a share of 0 to 1 along the range; by its logarithm where it spans decades."""
        if self.low > 0.0 and self.high / self.low > _LOGARITHMIC:
            return float(self.low * (self.high / self.low) ** share)
        return float(self.low + share * (self.high - self.low))


@dataclass(frozen=True)
class Candidate:
    """An effect (`id` of the registry) or the controller's open numbers (id 'controller')."""

    id: str
    title: str
    numbers: tuple[Number, ...]


CONTROLLER = "controller"


def candidates(
    base: Model, shaft_torque_nm: float, open_numbers: Mapping[str, tuple[float, float]]
) -> tuple[Candidate, ...]:
    """The controller's open numbers, if any, then every effect of the axle that the model can carry."""
    chain = chain_numbers(base)
    scene = Scene(shaft_torque_nm / chain.gear_ratio, shaft_torque_nm, chain._asdict())
    found = []
    if open_numbers:
        numbers = tuple(Number(name, "", low, high) for name, (low, high) in open_numbers.items())
        found.append(Candidate(CONTROLLER, "Open numbers of the controller", numbers))
    for effect in EFFECTS.values():
        usable = effect.probes is not None and not effect.makes and not effect.text_parameters
        if usable and effect.stage not in _OUT_OF_PLACE and base.kind in effect.needs:
            found.append(Candidate(effect.id, effect.title, plausible(effect, scene)))
    return tuple(candidate for candidate in found if candidate.numbers)


def plausible(effect: Effect, scene: Scene) -> tuple[Number, ...]:
    """The range of each number of an effect that is to be searched; the others keep their defaults.

    A figure or three tell no form of a law from another.
    """
    assert effect.probes is not None
    if any(parameter.name == "amplitude_nm" for parameter in effect.parameters):
        return _ripple(effect, scene)
    seen: dict[str, list[float]] = {}
    for probe in effect.probes(scene):
        for values in _corners(probe):
            for name, value in values.items():
                seen.setdefault(name, []).append(float(value))
    numbers = []
    for parameter in effect.parameters:
        if parameter.choices or parameter.beside:
            continue
        sizes = [*seen.get(parameter.name, []), *_opened(parameter)]
        low, high = _bounded(parameter, sizes)
        if high > low:
            numbers.append(Number(parameter.name, parameter.unit, low, high))
    return tuple(numbers)


def _corners(probe: Probe) -> Iterator[Mapping[str, float | str]]:
    ends = [(d.lower, d.upper) for d in probe.directions]
    for corner in itertools.product(*ends):
        yield probe.start(corner)


def _opened(parameter: Parameter) -> Sequence[float]:
    return (parameter.default, *parameter.opens) if any(parameter.opens) else ()


def _bounded(parameter: Parameter, sizes: Sequence[float]) -> tuple[float, float]:
    """The span of the sizes, within the declaration; (0, 0) without any."""
    inside = parameter.within or (parameter.lower, parameter.upper)
    kept = [min(max(size, inside[0]), inside[1]) for size in sizes if abs(size) < math.inf]
    return (min(kept), max(kept)) if kept else (0.0, 0.0)


def _ripple(effect: Effect, scene: Scene) -> tuple[Number, ...]:
    side: Literal["wheel", "rotor"] = "wheel" if effect.law.follows == "wheel" else "rotor"
    torque = scene.shaft_torque_nm if side == "wheel" else scene.torque_nm
    ranges = {
        "order": ORDERS[side],
        "amplitude_nm": (_LEAST_RIPPLE * torque, LARGEST_RIPPLE * torque),
        "phase_rad": (-math.pi, math.pi),
    }
    return tuple(Number(p.name, p.unit, *ranges[p.name]) for p in effect.parameters)
