"""A turning mass whose momentum is balanced: which speed turns it, what drives it, which laws brake it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from hil.analysis.missing_effects._noise import proven_noise
from hil.analysis.missing_effects._series import Series
from hil.core.chain import Chain
from hil.core.effects import Effect, Motion

Array = npt.NDArray[np.float64]

WINDOW_S = 0.1
"""Of impulses: long against a block and a dead time, short against what drag does."""
_QUIET = 1e-3  # of the largest speed: below it the sign of a speed is not known


@dataclass(frozen=True)
class Mass:
    """Momentum balance of a rigid axle over all recordings, on the rotor side."""

    series: tuple[Series, ...]
    ratio: float

    @cached_property
    def noise_rad_s(self) -> float:
        """Proven noise of a block mean of the speed."""
        motor, wheel, _ = proven_noise(self.series, {})
        return float(motor if np.isfinite(motor) else wheel * self.ratio)

    def speed(self, one: Series) -> Array:
        """Of the rotor in rad/s at block means."""
        measured = one.measured
        return np.asarray(measured[:, 0] if one.has[0] else measured[:, 1] * self.ratio)

    def wheel(self, one: Series) -> Array:
        """Wheel speed in rad/s at block means."""
        return np.asarray(one.measured[:, 1] if one.has[1] else one.measured[:, 0] / self.ratio)

    def angle(self, one: Series) -> Array:
        """Of the rotor in rad at block means."""
        return np.asarray(one.first_wheel_angle_rad * self.ratio + np.cumsum(self.speed(one)) / one.rate_hz)

    def speeds(self) -> list[Array]:
        """Of the rotor in all recordings."""
        return [self.speed(one) for one in self.series]

    def driving(self) -> list[Array]:
        """Torque in N m that acts on the mass in each recording, at block means."""
        found = []
        for one in self.series:
            brake = np.zeros(len(one.measured)) if one.load is None else block_means(one, one.load)
            found.append(block_means(one, one.torque) - brake / self.ratio)
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
        return any(one is not None for one in (law.dry, law.loss, law.load))

    def column(self, effect: Effect, values: dict[str, float | str], chain: Chain) -> Array:
        """Impulse of an effect's torque against positive motion."""
        return self.windowed([self._torque(one, effect, values, chain) for one in self.series], sums=True)

    def _torque(self, one: Series, effect: Effect, values: dict[str, float | str], chain: Chain) -> Array:
        numbers = tuple(float(values[p.name]) for p in effect.parameters)
        motor, wheel, angle = self.speed(one), self.wheel(one), self.angle(one)
        law, total = effect.law, np.zeros(len(motor))
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
            total += np.array([law.load(m, chain, 0.0, numbers) for m in motions]) / self.ratio
        return total


def mass_of(kind: str, series: Sequence[Series], ratio: float) -> Mass | None:
    """The mass of a rigid model; None for chains with shafts, or without a speed."""
    moving = tuple(one for one in series if one.has[:2].any())
    return Mass(moving, ratio) if kind == "rigid" and moving else None


def block_means(one: Series, values: Array) -> Array:
    """Means over the blocks of a recording of values at its samples."""
    count = len(one.measured)
    return np.asarray(values[: count * one.block].reshape(count, one.block).mean(axis=1))


def window_means(one: Series, values: Array) -> Array:
    """Means over the windows of impulses of values at blocks."""
    reach = max(1, round(WINDOW_S * one.rate_hz))
    whole, hop = np.cumsum(values), max(1, reach // 2)
    return np.asarray((whole[reach::hop] - whole[:-reach:hop]) / reach)
