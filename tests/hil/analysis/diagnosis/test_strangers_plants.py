"""Two inertias as others write them down, by another integrator: what is hidden is named with its numbers."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest

from hil.analysis.diagnosis import diagnose
from hil.core.model import Model
from hil.core.recording import Recording

K, D = 7000.0, 30.0
CAR = {
    "motor_inertia": 0.05,
    "gear_ratio": 9.3,
    "shaft_stiffness": K,
    "shaft_damping": D,
    "vehicle_inertia": 110.0,
    "torque_delay": 0.006,
}
NOISE = {"motor_speed_rad_s": 0.2, "wheel_speed_rad_s": 0.02, "shaft_torque_nm": 4.0}
STEP_S, FINER = 1e-3, 4

Law = Callable[[float, float], float]


def linear(twist: float, rate: float) -> float:
    return K * twist + D * rate


def dead_zone(gap: float) -> Law:
    """Flanks that damp while they touch, and never pull."""

    def torque(twist: float, rate: float) -> float:
        if abs(twist) <= gap:
            return 0.0
        side = math.copysign(1.0, twist)
        return side * max(side * (K * (twist - side * gap) + D * rate), 0.0)

    return torque


def in_oil(gap: float) -> Law:
    """The shafts' damper acts in the gap as well."""

    def torque(twist: float, rate: float) -> float:
        return K * (twist - min(max(twist, -gap), gap)) + D * rate

    return torque


def hardening(cubic: float) -> Law:
    return lambda twist, rate: linear(twist, rate) + cubic * twist**3


@dataclass(frozen=True)
class Plant:
    """`shaft` by twist and its rate, `loss` and `load` by speeds of rotor and wheel; a late shaft torque.

    `acts`: the share of the request that the motor makes.
    """

    shaft: Law = linear
    acts: float = 1.0
    loss: Callable[[float], float] = lambda speed: 0.0
    load: Callable[[float], float] = lambda speed: 0.0
    late_s: float = 0.0


@dataclass(frozen=True)
class Case:
    """What is hidden by names and numbers, and a base that is off by factors."""

    plant: Plant
    hidden: dict[tuple[str, str], float]
    off: dict[str, float] = field(default_factory=dict)


CASES = {
    "a dead zone": Case(
        Plant(dead_zone(0.012)), {("backlash", "half_gap_rad"): 0.012}, {"shaft_stiffness": 0.85}
    ),
    "oil in the gap": Case(
        Plant(in_oil(0.008)), {("backlash", "half_gap_rad"): 0.008}, {"shaft_damping": 2.0}
    ),
    "a fold": Case(
        Plant(hardening(1e5)), {("shaft_cubic_stiffness", "coefficient_nm_rad3"): 1e5}
    ),
    "two drags": Case(
        Plant(loss=lambda speed: 0.01 * speed, load=lambda speed: 0.15 * speed * abs(speed)),
        {("viscous_drag", "coefficient_nms_rad"): 0.01, ("running_resistance", "aero_nms2_rad2"): 0.15},
    ),
    "less torque than was asked for": Case(
        Plant(acts=0.92), {("torque_gain", "gain"): 0.92}, {"shaft_stiffness": 0.8}
    ),
    "a play and a late torque": Case(
        Plant(dead_zone(0.01), late_s=0.005),
        {("backlash", "half_gap_rad"): 0.01, ("channel_skew", "delay_s"): 0.005},
    ),
}  # fmt: skip


def recorded(plant: Plant, torque: np.ndarray, seed: int) -> Recording:
    """What such a plant shows of a torque from rest."""
    n, inertia, vehicle = CAR["gear_ratio"], CAR["motor_inertia"], CAR["vehicle_inertia"]
    late = np.concatenate([np.zeros(round(CAR["torque_delay"] / STEP_S)), torque])[: len(torque)]

    def slope(x: tuple[float, float, float], acting: float) -> tuple[float, float, float]:
        twist, rotor, wheel = x
        rate = rotor / n - wheel
        shaft = plant.shaft(twist, rate)
        return (
            rate,
            (plant.acts * acting - shaft / n - plant.loss(rotor)) / inertia,
            (shaft - plant.load(wheel)) / vehicle,
        )

    def moved(
        x: tuple[float, float, float], by: tuple[float, float, float], h: float
    ) -> tuple[float, float, float]:
        return x[0] + h * by[0], x[1] + h * by[1], x[2] + h * by[2]

    x, h, shown = (0.0, 0.0, 0.0), STEP_S / FINER, np.empty((len(torque), 3))
    for index, acting in enumerate(late.tolist()):
        shown[index] = x[1], x[2], plant.shaft(x[0], x[1] / n - x[2])
        for _ in range(FINER):
            a = slope(x, acting)
            b = slope(moved(x, a, 0.5 * h), acting)
            c = slope(moved(x, b, 0.5 * h), acting)
            d = slope(moved(x, c, h), acting)
            mean = tuple((p + 2.0 * q + 2.0 * r + s) / 6.0 for p, q, r, s in zip(a, b, c, d, strict=True))
            x = moved(x, (mean[0], mean[1], mean[2]), h)
    time = np.arange(len(torque)) * STEP_S
    shown[:, 2] = np.interp(time - plant.late_s, time, shown[:, 2])
    rng = np.random.default_rng(seed)
    channels = {
        name: shown[:, column] + level * rng.standard_normal(len(torque))
        for column, (name, level) in enumerate(NOISE.items())
    }
    return Recording({"time_s": time, "motor_torque_ref_nm": torque} | channels, Path(f"part_{seed}.csv"))


def chirp() -> np.ndarray:
    t = np.arange(0.0, 15.0, STEP_S)
    return 150.0 * np.sin(2.0 * np.pi * (0.5 * t + 0.5 * 24.5 / 15.0 * t**2))


def steps() -> np.ndarray:
    levels = np.random.default_rng(7).uniform(-150.0, 150.0, 20)
    return np.repeat(levels, round(0.75 / STEP_S))


def every_other(one: Recording) -> Recording:
    """The same by a logger of half the rate, which takes what there is: no filter before it."""
    return Recording({name: one[name][::2].copy() for name in one.channels}, Path(f"slow_{one.source}"))


@pytest.mark.slow
def test_two_rates_of_one_axle_hide_nothing() -> None:
    """1 kHz beside 500 Hz: half of the steps of the torque fall between the samples of the slower one."""
    fitted = [recorded(Plant(), torque, seed) for seed, torque in enumerate((chirp(), steps()))]
    found = diagnose(Model("two_inertia", CAR), [fitted[0], every_other(fitted[1])])
    assert found.verdict == "none", found.effects


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES.values(), ids=CASES.keys())
def test_what_others_hide_is_named_with_its_numbers(case: Case) -> None:
    base = Model("two_inertia", {name: value * case.off.get(name, 1.0) for name, value in CAR.items()})
    fitted = [recorded(case.plant, torque, seed) for seed, torque in enumerate((chirp(), steps()))]
    held = [recorded(case.plant, 0.7 * steps()[::-1].copy(), 2)]
    found = diagnose(base, fitted, held)
    told = {one.use.id: one.use.values for one in found.effects}
    assert told.keys() == {name for name, _ in case.hidden}
    for (name, number), value in case.hidden.items():
        assert float(told[name][number]) == pytest.approx(value, rel=0.01)
    assert all(one.confidence > 0.9 for one in found.effects)
    for name in case.off:
        assert found.model.parameters[name] == pytest.approx(CAR[name], rel=0.01)
    assert all(after.noises < 1.3 for after in found.holdout_after.values())
    for name, after in found.gap_after.items():  # at a fold what is left of a digit grows
        assert after.noises < 1.3 or after.gap < 0.05 * found.gap_before[name].gap
