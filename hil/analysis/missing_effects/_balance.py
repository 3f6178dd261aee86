"""Linear evidence on the latent torque of a turning mass: all laws at once, no search over simulations.

Momentum over impulse in short windows,

    J·Δω = ∫T dt - b·∫ω dt - Σ c_j·∫g_j(speed, angle) dt,

is linear in 1/J, b/J and the sizes c_j/J of laws g_j, which are those of the effects' own files at size one.
Nothing is differentiated and nothing drifts, so that inertia, drag and sizes come out the same from any base,
and each name gets numbers of its own to start a simulation from (an equation error method: L. Ljung, System
Identification, 1999, §10.1; as momentum balance for robots: M. Gautier, Proc. IEEE CDC 1997, 2170). What no
law takes is the latent torque.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from hil.analysis.missing_effects._hypothesis import Hypothesis
from hil.analysis.missing_effects._series import Series
from hil.core.chain import Chain
from hil.core.effects import EFFECTS, Effect, Motion
from hil.core.model import EffectUse, Model
from hil.plant import chain_numbers

Array = npt.NDArray[np.float64]

_WINDOW_S = 0.1  # long against a block and a dead time, short against what drag does
_QUIET = 1e-3  # of the largest speed: below it the sign of a speed is not known
_ORDERS = np.arange(0.05, 40.0, 0.05)
_PERIODS = 3.0  # of a ripple that a recording must hold
_PEAKS = 2  # orders of turning that are tried


@dataclass(frozen=True)
class _Mass:
    """Momentum balance of all recordings: speeds and angles of blocks, by windows; rotor side."""

    series: tuple[Series, ...]
    ratio: float

    def speed(self, one: Series) -> Array:
        """Rotor speed in rad/s at block means, as torque acts on it."""
        measured = one.measured
        return np.asarray(measured[:, 0] if one.has[0] else measured[:, 1] * self.ratio)

    def angle(self, one: Series) -> Array:
        """Rotor angle in rad at block means."""
        first = one.first_wheel_angle_rad * self.ratio
        return np.asarray(first + np.cumsum(self.speed(one)) / one.rate_hz)

    def windowed(self, values: Sequence[Array], *, sums: bool) -> Array:
        """Impulses of values (sums) or their change over each window, all recordings together."""
        found = []
        for one, value in zip(self.series, values, strict=True):
            reach = max(1, round(_WINDOW_S * one.rate_hz))
            whole = np.cumsum(value) / one.rate_hz if sums else value
            hop = max(1, reach // 2)
            found.append(whole[reach::hop] - whole[:-reach:hop])
        return np.concatenate(found)

    def column(self, effect: Effect, values: dict[str, float | str], chain: Chain) -> Array:
        """Impulse of an effect's torque against positive motion, rotor side."""
        return self.windowed([self._torque(one, effect, values, chain) for one in self.series], sums=True)

    def _torque(self, one: Series, effect: Effect, values: dict[str, float | str], chain: Chain) -> Array:
        numbers = tuple(float(values[p.name]) for p in effect.parameters)
        speed, angle = self.speed(one), self.angle(one)
        wheel = speed / self.ratio
        law, total = effect.law, np.zeros(len(speed))
        known = np.abs(speed) > _QUIET * float(np.max(np.abs(speed)))
        motions = [
            Motion(w, v, v, 0.0, 0.0, 0.0, 0.0, a, a / self.ratio)
            for w, v, a in zip(speed.tolist(), wheel.tolist(), angle.tolist(), strict=True)
        ]
        if law.dry is not None:
            total += np.array([law.dry(m, chain, 0.0, numbers) for m in motions]) * np.sign(speed) * known
        if law.loss is not None:
            total += np.array([law.loss(m, chain, 0.0, numbers) for m in motions])
        if law.load is not None:
            total += np.array([law.load(m, chain, 0.0, numbers) for m in motions]) / self.ratio
        return total


@dataclass(frozen=True)
class Reading:
    """A hypothesis with numbers as the balance reads them, and the share of the latent torque that stays."""

    hypothesis: Hypothesis
    left: float


def readings(hypothesis: Hypothesis, series: Sequence[Series]) -> list[Reading]:
    """The hypothesis itself, then with each further effect that acts on the mass, least left first.

    Empty for chains with shafts, or without a speed.
    """
    turning = tuple(one for one in series if one.has[:2].any())
    if hypothesis.kind != "rigid" or not turning:
        return []
    mass = _Mass(turning, hypothesis.base.parameters["gear_ratio"])
    alone = _read(mass, hypothesis)
    if alone is None:
        return []
    found = [
        reading for wider in _wider(mass, alone.hypothesis) if (reading := _read(mass, wider)) is not None
    ]
    return [alone, *sorted(found, key=lambda one: one.left)]


def _wider(mass: _Mass, hypothesis: Hypothesis) -> Iterator[Hypothesis]:
    """With one more effect, and with those of its optional numbers that act linearly."""
    taken = {use.id for use in (*hypothesis.base.effects, *hypothesis.terms)}
    for effect in EFFECTS.values():
        law = effect.law
        if effect.id in taken or hypothesis.kind not in effect.needs:
            continue
        if law.dry is None and law.loss is None and law.load is None:
            continue
        if law.follows is not None:
            for order in _orders(mass, hypothesis):
                yield hypothesis.with_term(
                    EffectUse(effect.id, {"order": order, "amplitude_nm": 1.0, "phase_rad": 0.0})
                )
            continue
        sizes = {name: 1.0 for name in effect.acting() if not effect.parameter(name).optional}
        yield hypothesis.with_term(EffectUse(effect.id, dict(sizes)))
        linear = frozenset(name for name in effect.acting() if effect.parameter(name).lower < 0.0)
        if linear - sizes.keys():
            yield hypothesis.with_term(EffectUse(effect.id, dict(sizes)), linear - sizes.keys())


def _orders(mass: _Mass, hypothesis: Hypothesis) -> list[float]:
    """Multiples of the rotor's angle that the torque left by a hypothesis follows best."""
    columns, right, _ = _regression(mass, hypothesis)
    rest = right - columns @ np.linalg.lstsq(columns, right, rcond=1e-9)[0]
    angle = (
        mass.windowed([np.cumsum(mass.angle(one)) / one.rate_hz for one in mass.series], sums=False)
        / _WINDOW_S
    )
    turns = float(np.ptp(angle)) / (2 * np.pi)
    power = np.array([abs(np.sum(rest * np.exp(-1j * order * angle))) for order in _ORDERS])
    best = np.argsort(power)[::-1]
    found: list[float] = []
    for at in best.tolist():
        if _ORDERS[at] * turns < _PERIODS:
            continue
        if all(abs(_ORDERS[at] - other) > 0.5 for other in found):
            found.append(float(_ORDERS[at]))
        if len(found) == _PEAKS:
            break
    return found


def _regression(mass: _Mass, hypothesis: Hypothesis) -> tuple[Array, Array, list[tuple[int, str, float]]]:
    """Columns (1/J, b/J, then sizes), the change of speed, and (term, number, phase) of each size."""
    chain = chain_numbers(hypothesis.base)
    torque = [_block_means(one, one.torque) for one in mass.series]
    brakes = [
        np.zeros_like(t) if one.load is None else _block_means(one, one.load)
        for one, t in zip(mass.series, torque, strict=True)
    ]
    driving = [t - b / mass.ratio for t, b in zip(torque, brakes, strict=True)]
    columns = [
        mass.windowed(driving, sums=True),
        -mass.windowed([mass.speed(one) for one in mass.series], sums=True),
    ]
    sizes: list[tuple[int, str, float]] = []
    for index, use in enumerate(hypothesis.terms):
        effect = EFFECTS[use.id]
        rest = dict(use.values) | dict.fromkeys(effect.acting(), effect.off)
        names = [
            n for n in effect.acting() if not effect.parameter(n).optional or n in hypothesis.opened[index]
        ]
        for name in names:
            for phase in (0.0, 0.5 * np.pi) if "phase_rad" in use.values else (0.0,):
                values = rest | {name: 1.0} | ({"phase_rad": phase} if "phase_rad" in use.values else {})
                columns.append(-mass.column(effect, values, chain))
                sizes.append((index, name, phase))
    change = mass.windowed([mass.speed(one) for one in mass.series], sums=False)
    return np.column_stack(columns), change, sizes


def _block_means(one: Series, values: Array) -> Array:
    count = len(one.measured)
    return np.asarray(values[: count * one.block].reshape(count, one.block).mean(axis=1))


def _read(mass: _Mass, hypothesis: Hypothesis) -> Reading | None:
    """Numbers of a hypothesis by the regression; None where they are not physical."""
    columns, right, places = _regression(mass, hypothesis)
    scale = np.maximum(np.max(np.abs(columns), axis=0), 1e-300)
    found = np.linalg.lstsq(columns / scale, right, rcond=1e-9)[0] / scale
    if found[0] <= 0.0:
        return None
    rest = right - columns @ found
    inertia, drag, sizes = 1.0 / found[0], max(found[1] / found[0], 0.0), found[2:] / found[0]
    model = hypothesis.base
    numbers = dict(model.parameters)
    share = inertia / (numbers["motor_inertia"] + numbers["vehicle_inertia"] / numbers["gear_ratio"] ** 2)
    numbers |= {name: numbers[name] * share for name in ("motor_inertia", "vehicle_inertia")}
    numbers["viscous_drag"] = drag
    terms = [dict(use.values) for use in hypothesis.terms]
    for (index, name, phase), size in zip(places, sizes.tolist(), strict=True):
        limits = EFFECTS[hypothesis.terms[index].id].parameter(name)
        if "phase_rad" not in terms[index]:
            terms[index][name] = min(max(size, limits.lower), limits.upper)
        elif phase == 0.0:
            terms[index]["phase_rad"], terms[index][name] = size, 0.0  # of a sine, until the cosine comes
        else:
            sine = float(terms[index]["phase_rad"])
            terms[index][name] = max(float(np.hypot(sine, size)), 1e-9)
            terms[index]["phase_rad"] = float(np.arctan2(size, sine))
    uses = tuple(EffectUse(use.id, values) for use, values in zip(hypothesis.terms, terms, strict=True))
    return Reading(
        replace(hypothesis, numbers=numbers, terms=uses), float(np.mean(rest**2)) / float(np.mean(right**2))
    )


def latent_torque(hypothesis: Hypothesis, series: Sequence[Series]) -> tuple[Array, Array, Array] | None:
    """What a hypothesis with its numbers leaves of the torque in N m, rotor side, with speed and angle there.

    One value a window: (windows,) each. None for chains with shafts, or without a speed.
    """
    turning = tuple(one for one in series if one.has[:2].any())
    if hypothesis.kind != "rigid" or not turning:
        return None
    mass = _Mass(turning, hypothesis.numbers["gear_ratio"])
    columns, change, places = _regression(mass, hypothesis)
    numbers = hypothesis.numbers
    inertia = numbers["motor_inertia"] + numbers["vehicle_inertia"] / numbers["gear_ratio"] ** 2
    explained = columns[:, 0] + numbers["viscous_drag"] * columns[:, 1] - inertia * change
    for column, (index, name, phase) in zip(columns[:, 2:].T, places, strict=True):
        values = hypothesis.terms[index].values
        size = float(values[name])
        if "phase_rad" in values:
            size *= np.cos(float(values["phase_rad"]) - phase)
        explained = explained + size * column
    means = [
        np.concatenate([_window_means(one, track(one)) for one in turning])
        for track in (mass.speed, mass.angle)
    ]
    return explained / _WINDOW_S, means[0], means[1]


def _window_means(one: Series, values: Array) -> Array:
    reach = max(1, round(_WINDOW_S * one.rate_hz))
    whole, hop = np.cumsum(values), max(1, reach // 2)
    return np.asarray((whole[reach::hop] - whole[:-reach:hop]) / reach)


def read_numbers(model: Model, series: Sequence[Series]) -> Hypothesis | None:
    """The numbers alone as the balance reads them beside dry friction and an offset."""
    alone = Hypothesis(model, dict(model.parameters))
    friction = alone.with_term(EffectUse("coulomb_friction", {"torque_nm": 1.0}), frozenset({"offset_nm"}))
    turning = tuple(one for one in series if one.has[:2].any())
    if model.kind != "rigid" or not turning or any(use.id == "coulomb_friction" for use in model.effects):
        return None
    found = _read(_Mass(turning, model.parameters["gear_ratio"]), friction)
    return None if found is None else replace(alone, numbers=found.hypothesis.numbers)
