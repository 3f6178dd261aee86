"""Every effect in both integrators: against each other, newer ones also against a reference integration."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from hil.core.effects import EFFECTS
from hil.core.model import EffectUse, Model
from hil.plant import Start, ideal_sensors, pack, simulate, simulate_many
from hil.plant.slots import place

DT = 1e-3
THREE = Model(
    "three_inertia",
    {
        "motor_inertia": 0.02,
        "gear_ratio": 8.148,
        "shaft_stiffness": 6089.0,
        "shaft_damping": 19.75,
        "wheel_inertia": 4.355,
        "tyre_stiffness": 5717.0,
        "tyre_damping": 351.0,
        "vehicle_inertia": 303.0,
        "torque_delay": 0.0,
    },
)
START = Start(8.148 * 5.0, 5.0, 0.0)
CHANNELS = ("motor_speed_rad_s", "wheel_speed_rad_s", "shaft_torque_nm")
USES = {
    "tyre_slip": {"slip_stiffness_nm": 6000.0, "relaxation_length_m": 0.35},
    "dyno_lag": {"time_constant_s": 0.05},
    "coulomb_friction": {"torque_nm": 2.0, "turn_rad": 0.3},
    "backlash": {"half_gap_rad": 0.004, "contact_damping_nms_rad": 15.0},
    "shaft_hysteresis": {"stiffness_nm_rad": 900.0, "slip_rad": 0.01},
    "shaft_cubic_stiffness": {"coefficient_nm_rad3": 4e5},
    "running_resistance": {"rolling_nm": 30.0, "aero_nms2_rad2": 0.1},
    "load_coulomb_friction": {"torque_nm": 30.0, "offset_nm": 5.0},
    "load_viscous_drag": {"coefficient_nms_rad": 4.0},
    "wheel_order_disturbance": {"order": 3.0, "amplitude_nm": 4.0, "phase_rad": 0.3},
    "motor_order_ripple": {"order": 2.0, "amplitude_nm": 0.4, "phase_rad": 0.3},
}


def torque(seconds: float = 4.0) -> np.ndarray:
    t = np.arange(0.0, seconds, DT)
    return 20.0 * np.sin(2 * np.pi * (0.5 * t + 1.2 * t**2))


def with_effect(id_: str, **changes: float) -> Model:
    values = EFFECTS[id_].check({**USES[id_], **changes}, "here")
    return THREE.with_effects(EffectUse(id_, values))


def stepped(model: Model) -> np.ndarray:
    out = simulate(model, torque(), DT, START)
    return np.column_stack([out[name] for name in CHANNELS])


def many(model: Model) -> np.ndarray:
    start = [[START.motor_speed_rad_s, START.wheel_speed_rad_s, START.shaft_torque_nm]]
    return simulate_many(pack(model)[None], torque(), DT, np.array(start), ideal_sensors(1))[0]


FORMS = [
    *((id_, {}) for id_ in USES),
    ("backlash", {"depth_damping_nms_rad2": 150.0}),
    ("backlash", {"contact_damping_nms_rad": 10.0, "contact_depth_rad": 1e-3}),
    ("coulomb_friction", {"turn_rad": 0.0, "stribeck_torque_nm": 1.0, "stribeck_speed_rad_s": 6.0}),
    ("coulomb_friction", {"turn_rad": 0.02, "stribeck_torque_nm": 1.0, "bristle_damping_nms_rad": 0.4}),
]


@pytest.mark.parametrize(("id_", "changes"), FORMS)
def test_both_integrators_see_the_same_effect(id_, changes):
    """Formulas are shared; only their steps differ (0.1 and 1 ms)."""
    a, b = stepped(with_effect(id_, **changes)), many(with_effect(id_, **changes))
    plain = stepped(THREE)
    between = np.sqrt(np.mean((a - b) ** 2, axis=0))
    effect = np.sqrt(np.mean((a - plain) ** 2, axis=0))
    assert np.all(effect > 0.0)
    assert np.all(between < 0.02 * effect + 1e-6 * np.std(plain, axis=0))


@pytest.mark.parametrize(
    "flanks",
    [
        {"tension": 0.5, "depth_damping_nms_rad2": 150.0},
        {"tension": 1.0, "depth_damping_nms_rad2": 150.0},
        {"one_spring": 1.0, "contact_depth_rad": 1e-3},
        {"film": 1.0},
    ],
)
def test_both_integrators_see_the_same_blows(flanks):
    """Torque changes as flanks meet and part, between two steps: a little sooner or later, speeds hardly."""
    model = with_effect("backlash", **flanks)
    a, b, plain = stepped(model), many(model), stepped(THREE)
    between = np.sqrt(np.mean((a - b) ** 2, axis=0))
    effect = np.sqrt(np.mean((a - plain) ** 2, axis=0))
    assert np.all(between < np.array([0.02, 0.02, 0.1]) * effect)


@pytest.mark.parametrize(
    ("id_", "before", "spelt_out"),
    [
        (
            "backlash",
            {},
            {
                "depth_damping_nms_rad2": 0.0,
                "tension": 0.0,
                "contact_depth_rad": 0.0,
                "one_spring": 0.0,
                "film": 0.0,
            },
        ),
        (
            "coulomb_friction",
            {"stribeck_torque_nm": 0.5},
            {"stribeck_speed_rad_s": 2.0, "stribeck_power": 2.0, "bristle_damping_nms_rad": 0.0},
        ),
    ],
)
def test_what_a_model_file_leaves_out_changes_nothing(id_, before, spelt_out):
    for kernel in (stepped, many):
        plain, told = kernel(with_effect(id_, **before)), kernel(with_effect(id_, **before, **spelt_out))
        assert np.array_equal(plain, told)


def reference(slope, states: int) -> np.ndarray:
    """Outputs of the chain with further states, by an integrator of others, the torque held."""
    u = torque()
    x = np.zeros(states)
    x[0], x[2], x[4] = START.motor_speed_rad_s, START.wheel_speed_rad_s, START.wheel_speed_rad_s
    if slope is turning:  # as if it had moved so for half a second
        x[5] = 2.0 * (1.0 - math.exp(-0.5 * x[0] / 0.3))
    p = THREE.parameters
    rows = []
    for k in range(len(u)):
        twist_rate = x[0] / p["gear_ratio"] - x[2]
        rows.append([x[0], x[2], p["shaft_stiffness"] * x[1] + p["shaft_damping"] * twist_rate])
        answer = solve_ivp(
            slope, (0.0, DT), x, method="DOP853", rtol=1e-9, atol=1e-9, args=(u[k],), t_eval=[DT]
        )
        x = answer.y[:, -1]
    return np.array(rows)


def chain(x: np.ndarray, torque_nm: float, loss: float, road: float, tyre: float) -> list[float]:
    p = THREE.parameters
    n = p["gear_ratio"]
    shaft = p["shaft_stiffness"] * x[1] + p["shaft_damping"] * (x[0] / n - x[2])
    return [
        (torque_nm - loss - shaft / n) / p["motor_inertia"],
        x[0] / n - x[2],
        (shaft - road) / p["wheel_inertia"],
        tyre,
        road / p["vehicle_inertia"],
    ]


def slipping(t, x, torque_nm):
    """The contract's form: T is the state, dT/dt = (r/σ)·(C·(ω_l - ω_v) - |ω_v|·T)."""
    c, length, r = 6000.0, 0.35, 0.33
    road = x[3] + THREE.parameters["tyre_damping"] * (x[2] - x[4])
    return chain(x, torque_nm, 0.0, road, r / length * (c * (x[2] - x[4]) - abs(x[4]) * x[3]))


def late(t, x, torque_nm):
    """The contract's form: τ·ω_d' = ω_v - ω_d; the tyre meets ω_d in place of ω_v."""
    p = THREE.parameters
    behind = x[2] - (x[5] + START.wheel_speed_rad_s)
    road = p["tyre_stiffness"] * x[3] + p["tyre_damping"] * behind
    return [*chain(x, torque_nm, 0.0, road, behind), (x[4] - (x[5] + START.wheel_speed_rad_s)) / 0.05]


def turning(t, x, torque_nm):
    """The contract's form: dF/dθ = (T_c/θ_t)·(1 - sgn(ω)·F/T_c)."""
    p = THREE.parameters
    road = p["tyre_stiffness"] * x[3] + p["tyre_damping"] * (x[2] - x[4])
    rate = x[0] * 2.0 / 0.3 * (1.0 - math.copysign(1.0, x[0]) * x[5] / 2.0)
    return [*chain(x, torque_nm, x[5], road, x[2] - x[4]), rate]


def braked(x, torque_nm, brake):
    """A torque on the wheel alone: the tyre carries none of it."""
    p = THREE.parameters
    road = p["tyre_stiffness"] * x[3] + p["tyre_damping"] * (x[2] - x[4])
    rates = chain(x, torque_nm, 0.0, road, x[2] - x[4])
    rates[2] -= brake / p["wheel_inertia"]
    return rates


def rubbing(t, x, torque_nm):
    """The contract's form: dry friction on the wheel, wheel side."""
    return braked(x, torque_nm, 30.0 * math.tanh(x[2] / 0.05) + 5.0)


def dragging(t, x, torque_nm):
    """The contract's form: drag proportional to the wheel's speed."""
    return braked(x, torque_nm, 4.0 * x[2])


@pytest.mark.parametrize(
    ("id_", "slope", "states"),
    [
        ("tyre_slip", slipping, 5),
        ("dyno_lag", late, 6),
        ("coulomb_friction", turning, 6),
        ("load_coulomb_friction", rubbing, 5),
        ("load_viscous_drag", dragging, 5),
    ],
)
@pytest.mark.parametrize("kernel", [stepped, many])
def test_an_effect_is_what_its_equation_says(id_, slope, states, kernel):
    exact, got = reference(slope, states), kernel(with_effect(id_))
    worst = np.max(np.abs(got - exact), axis=0) / np.std(exact, axis=0)
    assert np.all(worst < (1e-4 if kernel is stepped else 2e-3))


def test_an_effect_at_rest_is_none():
    nothing = THREE.with_effects(EffectUse("dyno_lag", {"time_constant_s": 0.0}))
    np.testing.assert_array_equal(stepped(nothing), stepped(THREE))
    np.testing.assert_array_equal(many(nothing), many(THREE))


@pytest.mark.parametrize("kernel", [0, 1])
def test_a_rotor_thrown_at_a_flank_comes_back_as_restitution_says(kernel):
    """From the middle of the gap towards a vehicle that does not move; the shafts have no damping."""
    p = THREE.parameters | {"shaft_damping": 0.0, "vehicle_inertia": 1e9}
    kept = {name: p[name] for name in p if "wheel" not in name and "tyre" not in name}
    values = EFFECTS["backlash"].check({"half_gap_rad": 0.02, "restitution": 0.6}, "here")
    model = Model("two_inertia", kept).with_effects(EffectUse("backlash", values))
    if kernel == 0:
        speed = simulate(model, np.zeros(60), DT, Start(20.0, 0.0, 0.0))["motor_speed_rad_s"]
    else:
        start = np.array([[20.0, 0.0, 0.0]])
        speed = simulate_many(pack(model)[None], np.zeros(60), DT, start, ideal_sensors(1))[0, :, 0]
    back = speed[np.argmin(speed) : np.argmin(speed) + 5]
    assert np.mean(back) == pytest.approx(-0.6 * 20.0, rel=0.01 if kernel == 0 else 0.08)


@pytest.mark.parametrize("bristles", [{}, {"stribeck_torque_nm": 1.0, "bristle_damping_nms_rad": 0.01}])
@pytest.mark.parametrize("speed", [-3.0, 3.0])
def test_friction_of_an_axle_that_begins_in_motion_has_turned_around(bristles, speed):
    """As Coulomb's law, which has no bristles to bend first, slows it in the first samples."""
    started = Start(speed, speed / THREE.parameters["gear_ratio"], 0.0)
    start = np.array([[started.motor_speed_rad_s, started.wheel_speed_rad_s, started.shaft_torque_nm]])
    at_once = {name: value for name, value in bristles.items() if "bristle" not in name} | {"turn_rad": 0.0}
    slowed = []
    for values in (bristles, at_once):
        model = with_effect("coulomb_friction", **values)
        alone = simulate(model, np.zeros(8), DT, started)["motor_speed_rad_s"]
        beside = simulate_many(pack(model)[None], np.zeros(8), DT, start, ideal_sensors(1))[0, :, 0]
        np.testing.assert_allclose(beside, alone, atol=1e-3 * abs(speed))
        slowed.append(abs(speed) - abs(alone[-1]))
    assert slowed[0] == pytest.approx(slowed[1], rel=0.05)


def test_bristles_of_an_axle_at_rest_are_straight():
    model = with_effect("coulomb_friction")
    assert np.all(simulate(model, np.zeros(20), DT, Start())["motor_speed_rad_s"] == 0.0)


def test_the_kernels_have_a_place_for_every_number():
    assert place("backlash", "restitution") == place("backlash", "half_gap_rad") + 2
    with pytest.raises(ValueError, match="not in tuple"):
        place("sensor_gain", "gain")
