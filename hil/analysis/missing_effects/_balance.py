"""Linear evidence on the latent torque of a turning mass: all laws at once, no search over simulations.

Momentum over impulse in short windows w,

    ∫wT dt = J·∫wω' dt + b·∫wω dt + Σ c_j·∫w g_j(speed, angle) dt,

is linear in J, b and the sizes c_j of laws g_j, which are those of the effects' own files at size one. What
is unsure is the torque: a drive's is noisier than its speed, whose proven noise is taken out.
Nothing is differentiated and nothing drifts, so that inertia, drag and sizes come out the same from any base,
and each name gets numbers of its own to start a simulation from (an equation error method: L. Ljung, System
Identification, 1999, §10.1; as momentum balance for robots: M. Gautier, Proc. IEEE CDC 1997, 2170). What no
law takes is the latent torque.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from hil.analysis.missing_effects._hypothesis import Hypothesis
from hil.analysis.missing_effects._mass import WINDOW_S, Mass, brakes, mass_of
from hil.analysis.missing_effects._orders import fineness, is_held, over_angle, peaks
from hil.analysis.missing_effects._series import Series
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse, Model
from hil.plant import chain_numbers

Array = npt.NDArray[np.float64]

_HIGHEST = 40.0  # order
_NEAR = np.arange(-8, 9)  # steps around a peak, which what stands beside it moves
_STEPS = (0.25, 0.03)  # widths of a peak
_PEAKS = 2  # orders of turning that are tried


@dataclass(frozen=True)
class Reading:
    """A hypothesis with numbers as the balance reads them, and the share of the latent torque that stays."""

    hypothesis: Hypothesis
    left: float
    sizes: int


def readings(hypothesis: Hypothesis, series: Sequence[Series]) -> list[Reading]:
    """Hypotheses with one further effect that acts on a mass, the likeliest first.

    Only those whose laws take more off the torque's impulse than their numbers cost. None for chains with
    shafts.
    """
    mass = mass_of(hypothesis.kind, series, hypothesis.numbers)
    alone = _read(mass, hypothesis) if mass else None
    if mass is None or alone is None:
        return []
    found: list[tuple[float, Reading]] = []
    for wider in _wider(mass, alone.hypothesis):
        reading = _read(mass, wider)
        if reading is not None and (gain := _gain(mass, alone, reading)) > 0.0:
            found.append((gain, replace(reading, left=reading.left / alone.left)))
    return [one for _, one in sorted(found, key=lambda pair: -pair[0])]


def _gain(mass: Mass, alone: Reading, reading: Reading) -> float:
    """Growth of the likelihood less what the numbers cost; half-lapped windows count half."""
    windows = 0.5 * len(mass.windowed(mass.driving(), sums=True))
    gain = 0.5 * windows * np.log(max(alone.left, 1e-300) / max(reading.left, 1e-300))
    return float(gain - 0.5 * (reading.sizes - alone.sizes) * np.log(windows))


def _wider(mass: Mass, hypothesis: Hypothesis) -> Iterator[Hypothesis]:
    """With one more effect, and with those of its optional numbers that act linearly."""
    taken = {use.id for use in (*hypothesis.base.effects, *hypothesis.terms)}
    for effect in EFFECTS.values():
        law = effect.law
        if effect.id in taken or hypothesis.kind not in effect.needs or not brakes(effect):
            continue
        if law.follows is not None:
            for order in _orders(mass, hypothesis):
                yield hypothesis.with_term(
                    EffectUse(effect.id, {"order": order, "amplitude_nm": 1.0, "phase_rad": 0.0})
                )
            continue
        sizes = dict.fromkeys(effect.acting_with(), 1.0)
        yield hypothesis.with_term(EffectUse(effect.id, dict(sizes)))
        linear = frozenset(name for name in effect.acting() if effect.parameter(name).lower < 0.0)
        if linear - sizes.keys():
            yield hypothesis.with_term(EffectUse(effect.id, dict(sizes)), linear - sizes.keys())


def _orders(mass: Mass, hypothesis: Hypothesis) -> list[float]:
    """Multiples of the rotor's angle that the torque left by a hypothesis follows best.

    Peaks of its transform over the angle, then what each order near them takes away beside all else.
    """
    columns, right, _ = _regression(mass, hypothesis)
    rest = right - columns @ _solved(mass, columns, right)
    angles = [mass.angle(one) for one in mass.series]
    middles = mass.window_means(angles)
    turns = max(float(np.ptp(middles)) / (2 * np.pi), 1e-9)
    basis = np.linalg.qr(columns)[0]

    def drop(order: float) -> float:
        turned = [np.exp(1j * order * angle) for angle in angles]
        wave = np.column_stack(
            [mass.windowed([part(one) for one in turned], sums=True) for part in (np.real, np.imag)]
        )
        wave = np.linalg.qr(wave - basis @ (basis.T @ wave))[0]
        return float(np.sum((wave.T @ rest) ** 2))

    fine = fineness(turns)
    power = np.abs(over_angle(rest, middles, fine, round(_HIGHEST / fine)))
    orders = fine * np.arange(1.0, len(power) + 1.0, dtype=np.float64)
    power[~is_held(orders, turns)] = 0.0
    found = []
    for peak in peaks(orders, power, 2 * _PEAKS):
        best = peak
        for step in _STEPS:
            near: Array = best + step / turns * _NEAR.astype(np.float64)
            best = float(max(near[is_held(near, turns)], key=drop, default=best))
        found.append((drop(best), best))
    return [order for _, order in sorted(found, reverse=True)[:_PEAKS]]


def _regression(mass: Mass, hypothesis: Hypothesis) -> tuple[Array, Array, list[tuple[int, str, float]]]:
    """Columns (inertia, drag, sizes), impulse of torque, (term, number, phase) of sizes."""
    chain = chain_numbers(hypothesis.base)
    columns = [mass.windowed(mass.speeds(), sums=sums) for sums in (False, True)]
    sizes: list[tuple[int, str, float]] = []
    for index, use in enumerate(hypothesis.terms):
        effect = EFFECTS[use.id]
        if not brakes(effect):
            continue
        rest = dict(use.values) | dict.fromkeys(effect.acting(), effect.off)
        for name in effect.acting_with(hypothesis.opened[index]):
            for phase in (0.0, 0.5 * np.pi) if "phase_rad" in use.values else (0.0,):
                values = rest | {name: 1.0} | ({"phase_rad": phase} if "phase_rad" in use.values else {})
                columns.append(mass.column(effect, values, chain))
                sizes.append((index, name, phase))
    return np.column_stack(columns), mass.windowed(mass.driving(), sums=True), sizes


def _solved(mass: Mass, columns: Array, right: Array) -> Array:
    """Numbers that leave least of the torque's impulse, without the bias by noise of the speeds.

    Noise of a change of speed would make the inertia too small; noise that is proven is taken out of the
    normal equations (T. Söderström, P. Stoica, System Identification, 1989, §8).
    """
    scale = np.maximum(np.max(np.abs(columns), axis=0), 1e-300)
    normal = (columns / scale).T @ (columns / scale)
    normal[0, 0] -= len(right) * (mass.change_noise_rad_s / scale[0]) ** 2
    return np.asarray(np.linalg.lstsq(normal, (columns / scale).T @ right, rcond=1e-12)[0] / scale)


def _read(mass: Mass, hypothesis: Hypothesis) -> Reading | None:
    """Numbers of a hypothesis by the regression; None where they are not physical."""
    columns, right, places = _regression(mass, hypothesis)
    if len(right) < 2 * columns.shape[1]:
        return None  # hardly a window in which it moves
    found = _solved(mass, columns, right)
    if found[0] <= 0.0:
        return None
    rest = right - columns @ found
    numbers, sizes = _as_one_mass(hypothesis.numbers, found[0], max(found[1], 0.0)), found[2:]
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
    left = float(np.mean(rest**2)) / float(np.mean(right**2))
    return Reading(replace(hypothesis, numbers=numbers, terms=uses), left, len(sizes))


def _as_one_mass(numbers: Mapping[str, float], inertia: float, drag: float) -> dict[str, float]:
    """Numbers of a rigid model of that inertia on the rotor side, shared out as they are."""
    share = inertia / (numbers["motor_inertia"] + numbers["vehicle_inertia"] / numbers["gear_ratio"] ** 2)
    return {**numbers} | {
        "motor_inertia": numbers["motor_inertia"] * share,
        "vehicle_inertia": numbers["vehicle_inertia"] * share,
        "viscous_drag": drag,
    }


def latent_torque(hypothesis: Hypothesis, series: Sequence[Series]) -> tuple[Array, Array, Array] | None:
    """What a hypothesis with its numbers leaves of the torque in N m, rotor side, with speed and angle there.

    One value a window: (windows,) each. None for chains with shafts, or without a speed.
    """
    mass = mass_of(hypothesis.kind, series, hypothesis.numbers)
    if mass is None:
        return None
    columns, impulse, places = _regression(mass, hypothesis)
    if not len(impulse):
        return None
    numbers = hypothesis.numbers
    inertia = numbers["motor_inertia"] + numbers["vehicle_inertia"] / numbers["gear_ratio"] ** 2
    left = impulse - inertia * columns[:, 0] - numbers["viscous_drag"] * columns[:, 1]
    for column, (index, name, phase) in zip(columns[:, 2:].T, places, strict=True):
        values = hypothesis.terms[index].values
        size = float(values[name])
        if "phase_rad" in values:
            size *= np.cos(float(values["phase_rad"]) - phase)
        left = left - size * column
    speed, angle = (
        mass.window_means([track(one) for one in mass.series]) for track in (mass.speed, mass.angle)
    )
    return left / WINDOW_S, speed, angle


def read_numbers(model: Model, series: Sequence[Series]) -> Hypothesis | None:
    """The numbers alone as the balance reads them beside dry friction and an offset."""
    alone = Hypothesis.alone(model)
    friction = alone.with_term(EffectUse("coulomb_friction", {"torque_nm": 1.0}), frozenset({"offset_nm"}))
    mass = mass_of(model.kind, series, model.parameters)
    if mass is None or any(use.id == "coulomb_friction" for use in model.effects):
        return None
    found = _read(mass, friction)
    return None if found is None else replace(alone, numbers=found.hypothesis.numbers)
