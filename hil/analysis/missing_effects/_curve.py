"""A missing torque as a picture: what a balance measures of it, over what it follows, beside its law.

What the momentum of a body does not account for is a torque; with its law it stands beside the law (a
partial residual). On the rotor it is T - T_s/n - J·ω', on a load behind the shafts T_s - J·ω', on a rigid
axle both at once; nothing is differentiated (`_mass`). A law of the shafts stands beside their recorded
torque, over the twist of the model. Other losses are taken out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.analysis.missing_effects._balance import latent_torque
from hil.analysis.missing_effects._hypothesis import Hypothesis, label_of
from hil.analysis.missing_effects._mass import (
    WINDOW_S,
    block_means,
    brakes,
    changes,
    impulses,
    law_torque,
    motions_of,
)
from hil.analysis.missing_effects._outcome import Curve, Replay
from hil.analysis.missing_effects._series import Series
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse
from hil.core.runtime.thread_map import map_on_threads

Array = npt.NDArray[np.float64]

_BINS = 24
_SPEED, _TWIST = "speed in rad/s", "twist in rad"


def curves_of(hypothesis: Hypothesis, replays: Sequence[Replay]) -> tuple[Curve, ...]:
    """Of each effect whose torque a balance measures; of a turning mass also what stays without a name.

    What stays is drawn over speed and over the angle within a turn, the one that explains more first.
    """
    series = [one.series for one in replays]
    named = [curve for use in hypothesis.terms if (curve := _of_effect(hypothesis, use, replays)) is not None]
    latent = latent_torque(hypothesis, series)
    if latent is None:
        return tuple(named)
    torque, speed, angle = latent
    stays = [
        _curve("", _SPEED, speed, torque, None),
        _curve("", "angle within a turn in rad", angle % (2.0 * np.pi), torque, None),
    ]
    return (*sorted(stays, key=lambda one: -one.share), *named)


def _of_effect(hypothesis: Hypothesis, use: EffectUse, replays: Sequence[Replay]) -> Curve | None:
    effect = EFFECTS[use.id]
    if effect.law.shaft is not None or effect.law.stretch is not None:
        return _of_shafts(hypothesis, use, replays)
    if not brakes(effect) and not _drag(hypothesis, use):
        return None
    bodies = [_body(hypothesis, one, on_load=effect.law.load is not None) for one in replays]
    seen = [_seen(hypothesis, use, body) for body in bodies if body is not None]
    if not seen:
        return None
    law, measured, over = (np.concatenate(parts) for parts in zip(*seen, strict=True))
    order = float(use.values.get("order", 0.0))
    place = f"angle within a period of order {order:.4g} in rad" if order else _SPEED
    return _curve(label_of(use), place, over, measured, law)


@dataclass(frozen=True)
class _Body:
    """What turns in a recording: what drives it (N m), rotor and wheel speed, by blocks; its inertia."""

    one: Series
    driving: Array
    rotor: Array
    wheel: Array
    inertia: float
    on_load: bool

    @property
    def speed(self) -> Array:
        """Its own, rad/s."""
        return self.wheel if self.on_load else self.rotor


def _body(hypothesis: Hypothesis, replay: Replay, *, on_load: bool) -> _Body | None:
    """The rotor, the load behind two inertias' shafts, or a rigid axle; None where not all was recorded."""
    one, chain, ratio = replay.series, hypothesis.chain(), hypothesis.chain().gear_ratio
    rotor, wheel, shaft = (block_means(one, values) for values in one.samples.T)
    rigid, regulated = hypothesis.kind == "rigid", bool(one.given.any())
    if rigid:
        rotor = rotor if np.isfinite(rotor[0]) else wheel * ratio
        wheel = wheel if np.isfinite(wheel[0]) else rotor / ratio
    held = replay.acting(hypothesis.model())  # from the sample before: at an instant the mean of both sides
    acting = block_means(one, 0.5 * (held + np.append(held[1:], held[-1])))
    brake = np.zeros(len(rotor)) if one.load is None or regulated else block_means(one, one.load)
    if rigid and not regulated:
        body = _Body(
            one,
            acting - brake / ratio,
            rotor,
            wheel,
            chain.motor_inertia + chain.vehicle_inertia / ratio**2,
            False,
        )
    elif not on_load:
        body = _Body(one, acting - shaft / ratio, rotor, wheel, chain.motor_inertia, False)
    elif hypothesis.kind == "two_inertia" and not regulated:
        body = _Body(one, shaft - brake, rotor, wheel, chain.vehicle_inertia, True)
    else:
        return None
    return body if np.isfinite(body.driving[0]) and np.isfinite(body.speed[0]) else None


def _seen(hypothesis: Hypothesis, use: EffectUse, body: _Body) -> tuple[Array, Array, Array]:
    """Torque of a law, the same with what the momentum leaves, and what it follows, by blocks."""
    one, chain = body.one, hypothesis.chain()
    angle = one.first_wheel_angle_rad * chain.gear_ratio + np.cumsum(np.nan_to_num(body.rotor)) / one.rate_hz
    rotor = np.nan_to_num(body.rotor)
    motions = motions_of(rotor, np.nan_to_num(body.wheel), angle, chain.gear_ratio)

    def torque(of: EffectUse) -> Array:
        effect = EFFECTS[of.id]
        on_load = effect.law.load is not None
        if not brakes(effect) or (on_load is not body.on_load and hypothesis.kind != "rigid"):
            return np.zeros(len(angle))
        numbers = tuple(float(of.values[parameter.name]) for parameter in effect.parameters)
        found = law_torque(effect, numbers, chain, motions, rotor)
        return found * chain.gear_ratio if body.on_load else found

    drag = _drag(hypothesis, use)
    law = torque(use) + drag * rotor
    beside = sum((torque(other) for other in hypothesis.terms if other is not use), np.zeros(len(angle)))
    if not body.on_load:
        beside = beside + (chain.viscous_drag - drag) * body.speed
    stays = impulses(one, body.driving - beside - law) - body.inertia * changes(one, body.speed)
    middles = impulses(one, np.arange(len(law), dtype=np.float64)) / WINDOW_S
    measured = law + np.interp(np.arange(len(law)), middles, stays / WINDOW_S)
    order = float(use.values.get("order", 0.0))
    return law, measured, angle % (2.0 * np.pi / order) if order else body.speed


def _drag(hypothesis: Hypothesis, use: EffectUse) -> float:
    """What an effect adds to the rotor's drag, N m s/rad."""
    without = hypothesis.without(hypothesis.terms.index(use))
    return float(hypothesis.chain().viscous_drag - without.chain().viscous_drag)


def _of_shafts(hypothesis: Hypothesis, use: EffectUse, replays: Sequence[Replay]) -> Curve | None:
    """Recorded torque of the shafts over the twist of the model, beside the model's torque."""
    model, chain = hypothesis.model(), hypothesis.chain()
    replays = [one for one in replays if one.series.has[2] and hypothesis.kind != "rigid"]
    if not replays:
        return None

    def seen(replay: Replay) -> tuple[Array, Array, Array]:
        one = replay.series
        shown = np.stack([block_means(one, values) for values in replay.outputs(model).T])
        rate = shown[0] / chain.gear_ratio - shown[1]
        twist = (np.cumsum(rate) - 0.5 * rate) / one.rate_hz
        return shown[2], one.measured[:, 2], twist - np.mean(twist - shown[2] / chain.shaft_stiffness)

    each = map_on_threads(seen, replays)
    law, measured, twist = (np.concatenate(parts) for parts in zip(*each, strict=True))
    return _curve(label_of(use), _TWIST, twist, measured, law)


def _curve(effect: str, over: str, at: Array, torque: Array, law: Array | None) -> Curve:
    """Means of the torque in bins of equal count, and the share of its variance that they explain."""
    edges = np.unique(np.quantile(at, np.linspace(0.0, 1.0, _BINS + 1)))
    place = np.clip(np.searchsorted(edges, at, side="right") - 1, 0, max(len(edges) - 2, 0))
    count = np.maximum(np.bincount(place), 1)
    mean, middle = (np.bincount(place, values) / count for values in (torque, at))
    spread = float(np.mean(torque**2))
    left = float(np.mean((torque - mean[place]) ** 2))
    beside = None if law is None else np.bincount(place, law) / count
    return Curve(effect, over, middle, mean, beside, 1.0 - left / max(spread, 1e-300))
