"""A mass whose momentum is balanced: which speeds turn it, what drives it, which laws brake it.

A rigid axle is one mass. Of a chain it is the rotor, where the shaft torque was measured; the load, where
that and its speed were; and both together, where both speeds were and no torque between them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
import numpy.typing as npt

from hil.analysis.missing_effects._noise import proven_noise
from hil.analysis.missing_effects._series import Series
from hil.core.chain import Chain
from hil.core.effects import Effect, Motion

Array = npt.NDArray[np.float64]
Part = Literal["rigid", "rotor", "load", "chain"]

WINDOW_S = 0.1
"""Of impulses: long against a block and a dead time, short against what drag does."""
_QUIET = 1e-3  # of the largest speed: below it the sign of a speed is not known


@dataclass(frozen=True)
class Mass:
    """Momentum balance of all recordings; torques on the rotor side, those of the load on the wheel side."""

    series: tuple[Series, ...]
    ratio: float
    part: Part

    @cached_property
    def noise_rad_s(self) -> tuple[float, ...]:
        """Proven noise of a block mean of each of `turning`."""
        motor, wheel, _ = proven_noise(self.series, {})
        if self.part == "chain":
            return float(motor), float(wheel / self.ratio)
        if self.part == "load":
            return (float(wheel),)
        return (float(motor if np.isfinite(motor) else wheel * self.ratio),)

    def motor(self, one: Series) -> Array:
        """Rotor speed in rad/s at block means."""
        measured = one.measured
        return np.asarray(measured[:, 0] if one.has[0] else measured[:, 1] * self.ratio)

    def wheel(self, one: Series) -> Array:
        """Wheel speed in rad/s at block means."""
        return np.asarray(one.measured[:, 1] if one.has[1] else one.measured[:, 0] / self.ratio)

    def speed(self, one: Series) -> Array:
        """Of the side that the balance stands on."""
        return self.wheel(one) if self.part == "load" else self.motor(one)

    def angle(self, one: Series) -> Array:
        """Angle in rad of that side at block means."""
        first = one.first_wheel_angle_rad * (1.0 if self.part == "load" else self.ratio)
        return np.asarray(first + np.cumsum(self.speed(one)) / one.rate_hz)

    def turning(self) -> list[list[Array]]:
        """Speeds that inertias go with, each of all recordings."""
        found = [[self.speed(one) for one in self.series]]
        if self.part == "chain":
            found.append([self.wheel(one) / self.ratio for one in self.series])
        return found

    def driving(self) -> list[Array]:
        """Torque in N m that acts on the mass in each recording, at block means."""
        found = []
        for one in self.series:
            shaft, brake = one.measured[:, 2], np.zeros(len(one.measured))
            if one.load is not None:
                brake = block_means(one, one.load)
            torque = block_means(one, one.torque)
            found.append(
                {
                    "rigid": torque - brake / self.ratio,
                    "chain": torque - brake / self.ratio,
                    "rotor": torque - shaft / self.ratio,
                    "load": shaft - brake,
                }[self.part]
            )
        return found

    def windowed(self, values: Sequence[Array], *, sums: bool) -> Array:
        """Impulses of values (sums) or their change over each window, all recordings together."""
        found = []
        for one, value in zip(self.series, values, strict=True):
            reach = max(1, round(WINDOW_S * one.rate_hz))
            whole = np.cumsum(value) / one.rate_hz if sums else value
            hop = max(1, reach // 2)
            found.append(whole[reach::hop] - whole[:-reach:hop])
        return np.concatenate(found)

    def braked_by(self, effect: Effect) -> bool:
        """Whether an effect's torque is in this balance."""
        law = effect.law
        on_rotor = law.dry is not None or law.loss is not None
        if self.part == "load":
            return law.load is not None
        return on_rotor or (self.part != "rotor" and law.load is not None)

    def column(self, effect: Effect, values: dict[str, float | str], chain: Chain) -> Array:
        """Impulse of an effect's torque against positive motion."""
        return self.windowed([self._torque(one, effect, values, chain) for one in self.series], sums=True)

    def _torque(self, one: Series, effect: Effect, values: dict[str, float | str], chain: Chain) -> Array:
        numbers = tuple(float(values[p.name]) for p in effect.parameters)
        motor, wheel = self.motor(one), self.wheel(one)
        law, total = effect.law, np.zeros(len(motor))
        angle = self.angle(one) * (self.ratio if self.part == "load" else 1.0)
        known = np.abs(motor) > _QUIET * float(np.max(np.abs(motor)))
        motions = [
            Motion(w, v, v, 0.0, 0.0, 0.0, 0.0, a, a / self.ratio)
            for w, v, a in zip(motor.tolist(), wheel.tolist(), angle.tolist(), strict=True)
        ]
        if law.dry is not None:
            total += np.array([law.dry(m, chain, 0.0, numbers) for m in motions]) * np.sign(motor) * known
        if law.loss is not None:
            total += np.array([law.loss(m, chain, 0.0, numbers) for m in motions])
        if law.load is not None:
            side = 1.0 if self.part == "load" else self.ratio
            total += np.array([law.load(m, chain, 0.0, numbers) for m in motions]) / side
        return total


def masses_of(kind: str, series: Sequence[Series], ratio: float) -> list[Mass]:
    """The masses of a model whose momentum the recordings give."""
    has = np.all([one.has for one in series], axis=0)
    parts: list[Part] = []
    if kind == "rigid" and any(one.has[:2].any() for one in series):
        series = [one for one in series if one.has[:2].any()]
        parts = ["rigid"]
    elif kind != "rigid" and has[2]:
        parts = ["rotor"] if has[0] else []
        parts += ["load"] if has[1] and kind == "two_inertia" else []
    elif kind == "two_inertia" and has[0] and has[1]:
        parts = ["chain"]
    return [Mass(tuple(series), ratio, part) for part in parts]


def block_means(one: Series, values: Array) -> Array:
    """Means over the blocks of a recording of values at its samples."""
    count = len(one.measured)
    return np.asarray(values[: count * one.block].reshape(count, one.block).mean(axis=1))


def window_means(one: Series, values: Array) -> Array:
    """Means over the windows of impulses of values at blocks."""
    reach = max(1, round(WINDOW_S * one.rate_hz))
    whole, hop = np.cumsum(values), max(1, reach // 2)
    return np.asarray((whole[reach::hop] - whole[:-reach:hop]) / reach)
