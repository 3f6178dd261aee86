"""Both sides of an axle: the lumped one where they are alike, another integrator's where they are not."""

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from benchmarks.split_friction import SHAFT_LIMIT_NM
from benchmarks.split_friction import ride as split_ride
from hil.analysis.diagnosis import diagnose
from hil.core.effects import EFFECTS
from hil.core.errors import BadInputError
from hil.core.model import EffectUse, Model
from hil.core.recording import Recording
from hil.fmu import Axle
from hil.plant import simulate
from hil.plant.closed_loop import tick as T
from tests.hil.plant.test_effects import THREE

P = THREE.parameters
ROAD = {"peak_nm": 3000.0, "sliding_nm": 2400.0}
ICE = {"friction_left": 0.05}
TORQUE = np.where(np.arange(1500) < 300, 0.0, 30.0)


def use(id_: str, **values: float) -> EffectUse:
    return EffectUse(id_, EFFECTS[id_].check(values, "here"))


def rows(*effects: EffectUse, torque: np.ndarray = TORQUE) -> np.ndarray:
    axle = Axle(Model("three_inertia", P, effects))
    axle.play(torque)
    return axle._loop.rows.copy()


@pytest.mark.parametrize("road", [(), (use("tyre_friction", peak_nm=150.0, sliding_nm=120.0),)])
def test_alike_sides_are_the_lumped_axle_to_the_last_bit(road: tuple[EffectUse, ...]) -> None:
    both = rows(*road, use("separate_wheels", differential_friction_nm=50.0))
    assert np.array_equal(both, rows(*road))


def test_an_open_differential_gives_both_shafts_the_same_torque() -> None:
    found = rows(use("tyre_friction", **ROAD), use("separate_wheels", **ICE))
    assert np.array_equal(found[:, T.SHAFT_LEFT], found[:, T.SHAFT_RIGHT])
    assert found[-1, T.WHEEL_LEFT] > 5.0 + found[-1, T.WHEEL_RIGHT]
    assert found[-1, T.LOAD_LEFT] == pytest.approx(0.05 * ROAD["sliding_nm"] / 2, rel=1e-3)


def test_what_knows_both_together_only_refuses_it() -> None:
    model = Model("three_inertia", P, (use("separate_wheels"),))
    with pytest.raises(BadInputError, match="both wheels together"):
        diagnose(model, [Recording({}, Path("none.csv"))])


def test_a_replay_shows_each_side_as_the_bench_does() -> None:
    effects = use("tyre_friction", **ROAD), use("separate_wheels", differential_friction_nm=40.0, **ICE)
    shown = simulate(Model("three_inertia", P, effects), TORQUE, 1e-3)
    found = rows(*effects)
    for name, column in (
        ("wheel_speed_left_rad_s", T.WHEEL_LEFT),
        ("wheel_speed_right_rad_s", T.WHEEL_RIGHT),
        ("shaft_torque_left_nm", T.SHAFT_LEFT),
        ("shaft_torque_right_nm", T.SHAFT_RIGHT),
    ):
        assert np.array_equal(shown[name], found[:, column]), name
    assert np.ptp(shown["wheel_speed_left_rad_s"] - shown["wheel_speed_right_rad_s"]) > 5.0


@pytest.mark.parametrize("friction_nm", [40.0, 1e5])
def test_a_differential_holds_both_sides_together_up_to_its_friction(friction_nm: float) -> None:
    found = rows(
        use("tyre_friction", **ROAD),
        use("separate_wheels", differential_friction_nm=friction_nm, **ICE),
        torque=np.where(np.arange(3000) < 300, 0.0, 30.0),
    )
    apart = found[:, T.SHAFT_RIGHT] - found[:, T.SHAFT_LEFT]
    assert np.abs(apart).max() <= friction_nm + 1e-9
    if friction_nm > 1e4:  # locked
        assert found[-1, T.WHEEL_LEFT] == pytest.approx(found[-1, T.WHEEL_RIGHT], rel=1e-3)
    else:
        assert apart[-1] == pytest.approx(friction_nm)


@pytest.mark.parametrize("friction_nm", [0.0, 40.0])
def test_another_integrator_with_each_wheel_of_its_own_finds_the_same(friction_nm: float) -> None:
    """Rotor, two shafts, two wheels, two tyres, vehicle: written side by side, not as sum and difference."""
    stiffness, damping = 0.5 * P["shaft_stiffness"], 0.5 * P["shaft_damping"]
    inertia = 0.5 * P["wheel_inertia"]

    def road(slip: float, twist: float, share: float) -> tuple[float, float]:
        held = 0.5 * share * (2400.0 + 600.0 * math.exp(-((slip / 3.0) ** 2)))
        sliding = abs(slip) * 0.5 * P["tyre_stiffness"] * twist / held
        return 0.5 * (P["tyre_stiffness"] * twist + P["tyre_damping"] * (slip - sliding)), slip - sliding

    def slope(_, x, torque):
        rotor, mean, left, right, tyre_left, tyre_right, vehicle, wound = x
        rate = rotor / P["gear_ratio"] - 0.5 * (left + right)
        half = stiffness * mean + damping * rate
        turning = -0.5 * (left - right)
        apart = stiffness * wound + damping * turning
        if abs(apart) > 0.5 * friction_nm:
            apart = math.copysign(0.5 * friction_nm, apart)
            turning = min(turning, 0.0) if apart > 0 else max(turning, 0.0)
        takes_left, twists_left = road(left - vehicle, tyre_left, 0.05)
        takes_right, twists_right = road(right - vehicle, tyre_right, 1.0)
        return [
            (torque - 2 * half / P["gear_ratio"]) / P["motor_inertia"],
            rate,
            (half + apart - takes_left) / inertia,
            (half - apart - takes_right) / inertia,
            twists_left,
            twists_right,
            (takes_left + takes_right) / P["vehicle_inertia"],
            turning,
        ]

    x, expected = np.zeros(8), []
    for torque in TORQUE:
        expected.append([x[0], x[2], x[3]])
        x = solve_ivp(slope, (0, 1e-3), x, rtol=1e-9, atol=1e-10, max_step=1e-4, args=(torque,)).y[:, -1]
    found = rows(
        use("tyre_friction", **ROAD), use("separate_wheels", differential_friction_nm=friction_nm, **ICE)
    )[:, [T.MOTOR_SPEED, T.WHEEL_LEFT, T.WHEEL_RIGHT]]
    assert np.abs(found - np.array(expected)).max() < 2e-4 * np.abs(found).max()


@pytest.mark.parametrize("friction_nm", [0.0, 300.0])
def test_both_half_shafts_stay_within_limits_on_a_road_that_is_slippery_on_one_side(
    friction_nm: float,
) -> None:
    found = split_ride("phase_stabilization", friction_nm)
    assert found.shaft_nm < 0.5 * SHAFT_LIMIT_NM
    assert (found.apart_rad_s < 1.0) == (friction_nm > 0)
