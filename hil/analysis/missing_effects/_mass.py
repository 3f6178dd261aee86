"""A turning mass whose momentum is balanced: which speed turns it, what drives it, which laws brake it."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import numpy.typing as npt

from hil.analysis.missing_effects._noise import proven_noise
from hil.analysis.missing_effects._series import Series
from hil.core.chain import Chain
from hil.core.effects import Effect, Motion

Array = npt.NDArray[np.float64]

WINDOW_S = 0.1
"""Half the length of a hat: long against a block and a dead time, short against what drag does."""
_QUIET = 1e-3  # of the largest speed: below it the sign of a speed is not known
_NOISES = 3.0  # nor is it below so many standard deviations


@dataclass(frozen=True)
class Mass:
    """Momentum balance of a rigid axle over all recordings, on the rotor side; its torque acts late."""

    series: tuple[Series, ...]
    ratio: float
    delay_s: float = 0.0
    _known: dict[Hashable, Array] = field(default_factory=dict, init=False, repr=False, compare=False)

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
            late = round(self.delay_s / one.dt)
            acting = np.concatenate([np.full(late, one.torque[0]), one.torque])[: len(one.torque)]
            found.append(block_means(one, acting) - brake / self.ratio)
        return found

    @cached_property
    def change_noise_rad_s(self) -> float:
        """Standard deviation by proven noise of a change of speed over a window: of two means' difference."""
        one = self.series[0]
        reach = _reach(one)
        # noise of what an angle turns by from block to block is differences itself: in a mean it cancels
        stays = 1.5 / reach if one.of_angle[0 if one.has[0] else 1] else 1.0
        return float(self.noise_rad_s * np.sqrt(2.0 / reach * stays))

    @cached_property
    def _moving(self) -> list[npt.NDArray[np.bool_]]:
        """Windows in which the sign of the speed is known, and with it that of friction."""
        found = []
        for one in self.series:
            speed = np.abs(self.speed(one))
            still = speed <= max(_QUIET * float(np.max(speed)), _NOISES * self.noise_rad_s)
            found.append(impulses(one, still.astype(float)) == 0.0)
        return found

    def windowed(self, values: Sequence[Array], *, sums: bool) -> Array:
        """Impulses of values (sums) or their change over each window that moves, all recordings together.

        Values are weighed by a hat, their change by its slope, which is the mean of its second half less that
        of its first: noise of single readings counts little (modulating functions: M. Shinbrot, Trans. ASME
        79 (1957) 547).
        """
        means = impulses if sums else changes
        every = zip(self.series, values, self._moving, strict=True)
        return np.concatenate([means(one, value)[moving] for one, value, moving in every])

    def window_means(self, values: Sequence[Array]) -> Array:
        """Means over the same windows."""
        return self.windowed(values, sums=True) / WINDOW_S

    def column(self, effect: Effect, values: dict[str, float | str], chain: Chain) -> Array:
        """Impulse of an effect's torque against positive motion."""
        numbers = tuple(float(values[p.name]) for p in effect.parameters)
        key = (effect.id, numbers, chain)
        if key not in self._known:
            every = zip(self._motions, self.speeds(), strict=True)
            torques = [law_torque(effect, numbers, chain, motions, speed) for motions, speed in every]
            self._known[key] = self.windowed(torques, sums=True)
        return self._known[key]

    @cached_property
    def _motions(self) -> list[list[Motion]]:
        """What laws see of each recording at block means."""
        return [
            motions_of(self.speed(one), self.wheel(one), self.angle(one), self.ratio) for one in self.series
        ]


def brakes(effect: Effect) -> bool:
    """Whether an effect is a torque against motion."""
    return any(one is not None for one in (effect.law.dry, effect.law.loss, effect.law.load))


def motions_of(rotor: Array, wheel: Array, angle: Array, ratio: float) -> list[Motion]:
    """What laws of losses see of rotor and wheel speed and the rotor's angle."""
    every = zip(*(one.tolist() for one in (rotor, wheel, angle)), strict=True)
    return [Motion(w, v, v, 0.0, 0.0, 0.0, 0.0, a, a / ratio) for w, v, a in every]


def law_torque(
    effect: Effect, numbers: tuple[float, ...], chain: Chain, motions: Sequence[Motion], rotor: Array
) -> Array:
    """Torque of an effect against positive motion in N m, rotor side."""
    law, total = effect.law, np.zeros(len(rotor))
    known = np.abs(rotor) > _QUIET * float(np.max(np.abs(rotor)))
    if law.dry is not None:
        total += np.array([law.dry(m, chain, 0.0, numbers) for m in motions]) * np.sign(rotor) * known
    if law.loss is not None:
        total += np.array([law.loss(m, chain, 0.0, numbers) for m in motions])
    if law.load is not None:
        total += np.array([law.load(m, chain, 0.0, numbers) for m in motions]) / chain.gear_ratio
    return total


def mass_of(kind: str, series: Sequence[Series], numbers: Mapping[str, float]) -> Mass | None:
    """The mass of a rigid model with such numbers; None for chains with shafts, or without a speed."""
    moving = tuple(one for one in series if one.has[:2].any())
    if kind != "rigid" or not moving:
        return None
    return Mass(moving, numbers["gear_ratio"], numbers.get("torque_delay", 0.0))


def block_means(one: Series, values: Array) -> Array:
    """Means over the blocks of a recording of values at its samples."""
    count = len(one.measured)
    return np.asarray(values[: count * one.block].reshape(count, one.block).mean(axis=1))


def impulses(one: Series, values: Array) -> Array:
    """Impulses over the windows of a recording: sums by a hat of height one and twice `WINDOW_S` long."""
    reach = _reach(one)
    between = 0.5 * (values[1:] + values[:-1])  # where speeds change
    means = _running(_running(between, reach), reach)
    return np.asarray(reach / one.rate_hz * means[:: _hop(reach)])


def changes(one: Series, values: Array) -> Array:
    """Change over the same windows: mean of the second half less that of the first."""
    reach = _reach(one)
    means = _running(values, reach)
    return np.asarray((means[reach:] - means[:-reach])[:: _hop(reach)])


def _running(values: Array, reach: int) -> Array:
    """Means of so many values in a row."""
    whole = np.concatenate([[0.0], np.cumsum(values)])
    return np.asarray((whole[reach:] - whole[:-reach]) / reach)


def _reach(one: Series) -> int:
    return max(1, round(WINDOW_S * one.rate_hz))


def _hop(reach: int) -> int:
    return max(1, reach // 2)
