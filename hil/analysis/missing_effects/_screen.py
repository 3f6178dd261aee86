"""Linear evidence over all names at once: what of the misfit could each effect take away?

Each effect is simulated at the sizes that its own file gives (`probes`). The change that it makes, beside
what all numbers and starts could do, says what it promises (`_projection`), and that ranks the names. One
optimum each, no search over simulations.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
import numpy.typing as npt

from hil.analysis.missing_effects._fit import Linearised, Point
from hil.analysis.missing_effects._hypothesis import Hypothesis, Laws, label_of, laws_of
from hil.analysis.missing_effects._orders import orders_of
from hil.analysis.missing_effects._problem import Problem
from hil.analysis.missing_effects._projection import Projection
from hil.core.channels import OUTPUTS
from hil.core.effects import EFFECTS, STRETCH, Direction, Effect, Probe
from hil.core.model import EffectUse
from hil.core.runtime.thread_map import map_on_threads
from hil.plant import chain_numbers

Array = npt.NDArray[np.float64]

NUMBERS = {"dead_time": "torque_delay", "viscous_drag": "viscous_drag"}
"""Effects that are a change of a number which a base may have, and which is free there."""
_AT_ONCE = 24  # simulations
_SIDES: tuple[Literal["wheel", "rotor"], ...] = ("wheel", "rotor")
_STRETCHED = (Direction({}, *STRETCH),)


@dataclass(frozen=True)
class Promise:
    """An effect at a size beside a point, and the growth of log L that it promises to first order.

    `numbers` is the point's hypothesis with numbers moved as that promise has them.
    """

    use: EffectUse
    point: Point
    gain: float
    numbers: Hypothesis

    @property
    def label(self) -> str:
        """The effect's name with its channel."""
        return label_of(self.use)


@dataclass(frozen=True)
class Scene:
    """What probes take their sizes from; orders of turning are those of the misfit at a point."""

    problem: Problem
    hypothesis: Hypothesis
    point: Point | None = None

    @cached_property
    def torque_nm(self) -> float:
        return float(max(np.max(np.abs(one.torque)) for one in self.problem.series))

    @cached_property
    def power_w(self) -> float:
        ratio = self.parameters["gear_ratio"]
        seen = [0.0]
        for one in self.problem.series:
            speed = one.samples[:, 0] if one.has[0] else ratio * one.samples[:, 1]
            seen.append(float(np.max(np.nan_to_num(np.abs(one.torque * speed)))))
        return max(seen)

    @cached_property
    def shaft_torque_nm(self) -> float:
        seen = [np.nanmax(np.abs(one.samples[:, 2])) for one in self.problem.series if one.has[2]]
        return float(max(seen)) if seen else 0.5 * self.torque_nm * self.parameters["gear_ratio"]

    @cached_property
    def parameters(self) -> dict[str, float]:
        return dict(chain_numbers(self.hypothesis.model())._asdict())

    @cached_property
    def channels(self) -> tuple[str, ...]:
        has = np.any([one.has for one in self.problem.series], axis=0)
        return tuple(name for name, there in zip(OUTPUTS, has, strict=True) if there)

    def orders(self, side: Literal["wheel", "rotor"]) -> list[float]:
        return self._orders[side]

    @cached_property
    def _orders(self) -> dict[Literal["wheel", "rotor"], list[float]]:
        point = self.point
        if point is None:
            return {side: [] for side in _SIDES}
        each = map_on_threads(lambda side: orders_of(self.problem, point, side), _SIDES)
        return dict(zip(_SIDES, each, strict=True))


def promises(
    problem: Problem, at: Linearised, asked: Callable[[EffectUse], bool] = lambda _: True
) -> list[Promise]:
    """All sizes of every effect that may be added to a point, each with what it promises.

    Args:
        asked: which effects are looked at, by their ids; all of them when left out.
    """
    leaps = problem.model.kind == "rigid" and any(one.has[2] for one in problem.series)
    if leaps:  # its shaft torque with a delay, where a slope sees it glide
        at = at.holding([one.name == "torque_delay" for one in at.coordinates])
    project = Projection(problem, at)
    joining = list(_asked(Scene(problem, at.point.hypothesis, at.point), asked))
    found = _promised(project, [one for one in joining if one[1].first])
    best: dict[str, tuple[float, int]] = {}
    for promise, place in found:
        best[promise.label] = max(best.get(promise.label, (0.0, place)), (promise.gain, place))
    closer = [
        (uses, probe)
        for uses, probe in joining
        if not probe.first and abs(probe.place - best.get(label_of(uses[0]), (0.0, -2))[1]) <= 1
    ]
    return [promise for promise, _ in (*found, *_promised(project, closer))]


def _promised(
    project: Projection, joining: Sequence[tuple[list[EffectUse], Probe]]
) -> list[tuple[Promise, int]]:
    """What sizes of effects promise, each with the place of its probe."""
    at, found = project.at, []
    hypothesis = at.point.hypothesis
    for some in _together(joining):
        alone = project.products([hypothesis.with_term(use) for uses, _ in some for use in uses])
        first = 0
        for uses, probe in some:
            which, first = slice(first, first + len(uses)), first + len(uses)
            taken = project.explained(alone, which, probe.directions)
            use = EffectUse(uses[0].id, dict(probe.start(taken.factors)))
            numbers = hypothesis.moved(at.coordinates, taken.moves)
            found.append((Promise(use, at.point, taken.gain, numbers), probe.place))
    return found


def _asked(scene: Scene, asked: Callable[[EffectUse], bool]) -> Iterator[tuple[list[EffectUse], Probe]]:
    """All sizes of the effects that may join, with the uses whose changes add up to each."""
    for effect in EFFECTS.values():
        if asked(EffectUse(effect.id, {})) and may_join(effect, scene.hypothesis):
            for probe in probes_of(effect, scene):
                uses = [EffectUse(effect.id, dict(one.values)) for one in probe.directions]
                if not {label_of(use) for use in uses} & {*scene.hypothesis.names}:
                    yield uses, probe


def _together(
    asked: Iterable[tuple[list[EffectUse], Probe]],
) -> Iterator[list[tuple[list[EffectUse], Probe]]]:
    """As many as are simulated at once."""
    some: list[tuple[list[EffectUse], Probe]] = []
    for one in asked:
        some.append(one)
        if sum(len(uses) for uses, _ in some) >= _AT_ONCE:
            yield some
            some = []
    if some:
        yield some


def may_join(effect: Effect, hypothesis: Hypothesis) -> bool:
    """Whether an effect can be added to a hypothesis: its kind fits, and a place for it is free."""
    if effect.id in ("parameter_mismatch", "sensor_quantization"):
        return False  # numbers are free anyway; rounding is seen in the readings themselves
    if hypothesis.kind not in effect.needs or NUMBERS.get(effect.id) in hypothesis.base.parameters:
        return False
    taken = {use.id for use in (*hypothesis.base.effects, *hypothesis.terms)}
    return bool(effect.text_parameters) or effect.id not in taken


def probes_of(effect: Effect, scene: Scene) -> Iterator[Probe]:
    """Sizes of an effect to try, by its own file or by the unit of its first number."""
    if effect.probes is not None:
        yield from effect.probes(scene)
    first = effect.parameters[0]
    if effect.law.load is None and effect.law.dry is None:
        return  # others have sizes of their own that follow the scene
    for share in (0.01, 0.1):
        others = {p.name: 0.0 for p in effect.parameters if not p.optional}
        values = effect.completed(others | {first.name: share * _size(effect, scene)})
        yield Probe((Direction(values, 0.0, 10.0),), _scaled(values, first.name))


def _scaled(values: dict[str, float | str], name: str) -> Callable[[Sequence[float]], dict[str, float | str]]:
    """Values with one of them times a factor, not quite zero."""
    return lambda factors: values | {name: max(float(factors[0]), 0.1) * float(values[name])}


def _size(effect: Effect, scene: Scene) -> float:
    """A large size of an effect's first number, by its unit: a torque, or a torque over a speed."""
    torque = scene.torque_nm * scene.parameters["gear_ratio"]
    if effect.parameters[0].unit == "N m":
        return torque
    speeds = [one.samples[:, :2][:, one.has[:2]] for one in scene.problem.series if any(one.has[:2])]
    speed = float(np.sqrt(np.mean([np.nanmean(one**2) for one in speeds]))) if speeds else 1.0
    return torque / max(speed, 1e-9)


def promised_by(problem: Problem, at: Linearised, hypotheses: Sequence[Hypothesis]) -> list[float]:
    """Growth of log L that neighbours of a point promise to first order, of about their sizes."""
    project = Projection(problem, at)
    of = project.products(hypotheses)
    return [project.explained(of, slice(i, i + 1), _STRETCHED).gain for i in range(len(hypotheses))]


def best_by_name(found: Sequence[Promise]) -> list[Promise]:
    """The most promising size of every name and law, the best first.

    Laws that an effect may have are promised what only a fit can tell apart.
    """
    best: dict[tuple[str, Laws], Promise] = {}
    for one in sorted(found, key=lambda one: -one.gain):
        best.setdefault((one.label, laws_of(one.use)), one)
    return list(best.values())
