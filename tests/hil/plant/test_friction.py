"""Dry friction of both kernels against closed forms, energy, and each other."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hil.core.model import EffectUse, Model
from hil.plant import Start, ideal_sensors, pack, simulate, simulate_many

DT = 1e-3
INERTIA = 0.02 + 300.0 / 64.0
RIGID = Model(
    "rigid",
    {
        "motor_inertia": 0.02,
        "gear_ratio": 8.0,
        "vehicle_inertia": 300.0,
        "viscous_drag": 0.0,
        "torque_delay": 0.0,
    },
)
# A rotor on a spring whose other end does not move
STIFFNESS = 8.0
SPRING = Model(
    "two_inertia",
    {
        "motor_inertia": 0.02,
        "gear_ratio": 1.0,
        "shaft_stiffness": STIFFNESS,
        "shaft_damping": 0.0,
        "vehicle_inertia": 1e12,
        "torque_delay": 0.0,
    },
)
CHAIN = {
    "motor_inertia": 0.02,
    "gear_ratio": 8.148,
    "shaft_stiffness": 6089.0,
    "shaft_damping": 19.75,
    "vehicle_inertia": 303.0,
    "torque_delay": 0.0083,
}
TWO = Model("two_inertia", CHAIN)
THREE = Model(
    "three_inertia", CHAIN | {"wheel_inertia": 4.355, "tyre_stiffness": 5717.0, "tyre_damping": 351.0}
)
MOUNT = EffectUse(
    "mount_mode",
    {"housing_inertia_kg_m2": 2.0, "mount_stiffness_nm_rad": 2e4, "mount_damping_nms_rad": 30.0},
)
CHANNELS = ("motor_speed_rad_s", "wheel_speed_rad_s", "shaft_torque_nm")


def dry(model: Model, torque: float, stribeck: float = 0.0, offset: float = 0.0) -> Model:
    values: dict[str, float | str] = {
        "torque_nm": torque,
        "stribeck_torque_nm": stribeck,
        "offset_nm": offset,
    }
    return model.with_effects(*model.effects, EffectUse("coulomb_friction", values))


def step_by_step(model: Model, torque: np.ndarray, start: Start | None = None) -> np.ndarray:
    """The bench's kernel: n x 3."""
    channels = simulate(model, torque, DT, start)
    return np.column_stack([channels[name] for name in CHANNELS])


def many(model: Model, torque: np.ndarray, start: Start | None = None) -> np.ndarray:
    """The kernel of the fits: n x 3."""
    s = start or Start()
    begin = np.array([[s.motor_speed_rad_s, s.wheel_speed_rad_s, s.shaft_torque_nm]])
    return np.asarray(simulate_many(pack(model)[None], torque, DT, begin, ideal_sensors(1))[0])


kernels = pytest.mark.parametrize("kernel", [step_by_step, many])


@kernels
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_a_block_does_not_move_at_all_below_the_break_away_torque(kernel, sign):
    got = kernel(dry(RIGID, 3.0, 1.0), np.full(2000, 3.99 * sign))
    assert np.all(np.abs(got) < 1e-12)


@kernels
@pytest.mark.parametrize("model", [TWO, THREE, THREE.with_effects(MOUNT)])
def test_nor_does_a_rotor_against_its_shafts_or_in_its_mount(kernel, model):
    assert np.all(np.abs(kernel(dry(model, 3.0), np.full(2000, 2.9))) < 1e-12)
    ramp = np.concatenate([np.linspace(0.0, 2.9, 1000), np.full(1000, 2.9)])
    got = kernel(dry(model, 3.0), ramp)
    assert np.all(np.abs(got[:, 0]) < 1e-12)
    # the fits' kernel has one mean friction a step: a changing torque twists by some 1e-6 rad
    assert np.all(np.abs(got[:, 2]) < (1e-12 if kernel is step_by_step else 1e-2))


@kernels
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_above_it_a_block_accelerates_with_what_friction_leaves(kernel, sign):
    got = kernel(dry(RIGID, 3.0), np.full(2000, 5.0 * sign))
    speed = sign * (5.0 - 3.0) / INERTIA * np.arange(2000) * DT
    np.testing.assert_allclose(got[:, 0], speed, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(got[:, 1], speed / 8.0, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(got[:, 2], sign * 2.0 * 300.0 / 8.0 / INERTIA, rtol=1e-9)


@kernels
def test_the_offset_shifts_what_friction_can_hold(kernel):
    assert np.all(np.abs(kernel(dry(RIGID, 3.0, offset=1.0), np.full(500, 3.9))[:, 0]) < 1e-12)
    assert np.all(np.abs(kernel(dry(RIGID, 3.0, offset=1.0), np.full(500, -1.9))[:, 0]) < 1e-12)
    assert kernel(dry(RIGID, 3.0, offset=1.0), np.full(500, -2.1))[-1, 0] < 0.0


@kernels
def test_a_block_slows_down_evenly_and_stays(kernel):
    got = kernel(dry(RIGID, 3.0), np.zeros(4000), Start(2.0, 0.25))
    speed = np.maximum(0.0, 2.0 - 3.0 / INERTIA * np.arange(4000) * DT)
    np.testing.assert_allclose(got[:, 0], speed, atol=1e-9)
    assert np.all(np.abs(got[3200:]) < 1e-12)


@kernels
@pytest.mark.parametrize("torque", [0.3, 0.7])
def test_a_mass_on_a_spring_loses_four_friction_twists_a_cycle_and_sticks(kernel, torque):
    # closed form: each half cycle the spring's torque changes sign and loses 2 Tc, until Tc holds it
    first = 10.1
    extremes = [first]
    while abs(extremes[-1]) > torque:
        extremes.append(-np.sign(extremes[-1]) * (abs(extremes[-1]) - 2.0 * torque))
    got = kernel(dry(SPRING, torque), np.zeros(6000), Start(0.0, 0.0, first))[:, 2]
    half_s = np.pi * np.sqrt(0.02 / STIFFNESS)
    at = np.minimum(np.round(np.arange(len(extremes)) * half_s / DT).astype(int), 5999)
    np.testing.assert_allclose(got[at], extremes, atol=5e-3)
    turning = got[2:][(np.diff(got[1:]) * np.diff(got[:-1]) < 0.0)]
    assert len(turning) <= len(extremes)
    assert got[-1] == pytest.approx(extremes[-1], abs=2e-3)
    assert abs(got[-1]) <= torque
    assert np.ptp(got[at[-1] + 2 :]) < 1e-9  # it does not creep back


@pytest.mark.parametrize("model", [RIGID, TWO, THREE, THREE.with_effects(MOUNT)])
@pytest.mark.parametrize("friction", [(2.0, 0.0, 0.0), (2.0, 0.5, 0.1), (5.0, 2.0, 0.0)])
def test_both_kernels_agree_on_a_chirp_with_reversals(model, friction):
    time = np.arange(12_000) * DT
    wander = 0.02 * np.cumsum(np.random.default_rng(0).normal(size=len(time)))
    torque = 12.0 * np.sin(2 * np.pi * (0.3 * time + time**2)) + wander
    one, other = step_by_step(dry(model, *friction), torque), many(dry(model, *friction), torque)
    compared = CHANNELS[:2] if model.kind == "rigid" else CHANNELS  # its T_s jumps with the friction
    for column, channel in enumerate(compared):
        rms = np.sqrt(np.mean((one[:, column] - other[:, column]) ** 2))
        assert rms < 1e-3 * np.std(one[:, column]), channel


@kernels
@settings(max_examples=25)
@given(
    friction=st.floats(0.01, 20.0),
    stribeck=st.floats(0.0, 10.0),
    speed=st.floats(-50.0, 50.0),
    shaft=st.floats(-400.0, 400.0),
    damping=st.sampled_from([0.0, 5.0]),
)
def test_energy_is_never_created(kernel, friction, stribeck, speed, shaft, damping):
    model = dry(TWO.with_parameters(shaft_damping=damping), friction, stribeck)
    got = kernel(model, np.zeros(800), Start(speed, 0.0, shaft))
    motor, wheel, torque = got.T
    stretch = torque - damping * (motor / CHAIN["gear_ratio"] - wheel)
    energy = 0.5 * (
        CHAIN["motor_inertia"] * motor**2
        + CHAIN["vehicle_inertia"] * wheel**2
        + stretch**2 / CHAIN["shaft_stiffness"]
    )
    error = 1e-12 * max(energy[0], 1e-6)
    if kernel is many:  # one mean friction in the step in which the rotor stops: T h times the speed T h / J
        error = ((friction + stribeck) * DT) ** 2 / CHAIN["motor_inertia"]
    assert np.max(np.diff(energy)) <= error
