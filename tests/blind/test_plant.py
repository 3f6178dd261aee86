"""The reference plant against closed forms."""

from __future__ import annotations

import math

import control
import numpy as np
import pytest

from tests.blind.experiments import SAMPLE_S, Experiment, holdout_set, main_set
from tests.blind.plant import Truth, read_by_sensors, true_outputs
from tests.blind.reference.contact import series_contact, shaft_torque
from tests.blind.reference.friction import bristle_after, friction_torque
from tests.blind.reference.hysteresis import BOUC_WEN, ELEMENTS, MASING, advance
from tests.blind.reference.layout import record
from tests.blind.reference.torque_path import acting, delayed
from tests.blind.sensors import Sensor, coloured_noise

TWO = {
    "motor_inertia": 0.02,
    "gear_ratio": 8.148,
    "shaft_stiffness": 6089.0,
    "shaft_damping": 19.75,
    "vehicle_inertia": 303.0,
    "torque_delay": 0.0083,
}
THREE = TWO | {"wheel_inertia": 4.355, "tyre_stiffness": 5717.0, "tyre_damping": 351.0}
RIGID = {
    "motor_inertia": 0.02,
    "gear_ratio": 8.0,
    "vehicle_inertia": 300.0,
    "viscous_drag": 0.0,
    "torque_delay": 0.0083,
}


def _open_loop(torque_nm: np.ndarray, wheel_speed: float = 0.0) -> Experiment:
    return Experiment("test", torque_nm, np.zeros_like(torque_nm), wheel_speed)


def test_rigid_body_under_constant_torque_after_a_fractional_dead_time():
    _, out = true_outputs(Truth("rigid", RIGID), _open_loop(np.full(1000, 10.0)))
    inertia = 0.02 + 300.0 / 64.0
    expected = 10.0 / inertia * np.maximum(np.arange(1000) * SAMPLE_S - 0.0083, 0.0)
    np.testing.assert_allclose(out[:, 0], expected, atol=1e-9)
    np.testing.assert_allclose(out[:, 1], expected / 8.0, atol=1e-9)
    np.testing.assert_allclose(out[20:, 2], 10.0 * 8.0 * (300.0 / 64.0) / inertia, rtol=1e-9)


@pytest.mark.parametrize(
    ("kind", "parameters", "laws"),
    [
        ("two_inertia", TWO, {}),
        ("three_inertia", THREE, {}),
        (
            "three_inertia",
            THREE,
            {"has_mount": 1.0, "housing_inertia": 6.0, "mount_stiffness": 5e4, "mount_damping": 60.0},
        ),
        (
            "three_inertia",
            THREE,
            {"absorber_inertia": 1.0, "absorber_stiffness": 900.0, "absorber_damping": 2.0},
        ),
    ],
    ids=["two inertias", "three inertias", "on bushes", "with absorber"],
)
@pytest.mark.parametrize("frequency_hz", [2.0, 8.0, 25.0])
def test_frequency_response_of_the_linear_chain(kind, parameters, laws, frequency_hz):
    truth = Truth(kind, parameters, laws)
    time_s = np.arange(8000) * SAMPLE_S
    omega = 2.0 * math.pi * frequency_hz
    _, out = true_outputs(truth, _open_loop(20.0 * np.sin(omega * time_s)))
    late = time_s > 4.0
    base = np.stack(
        [np.sin(omega * time_s[late]), np.cos(omega * time_s[late]), np.ones(late.sum()), time_s[late]],
        axis=1,
    )
    fit = np.linalg.lstsq(base, out[late], rcond=None)[0]
    measured = (fit[0] + 1j * fit[1]) / 20.0
    held = np.sinc(frequency_hz * SAMPLE_S) * np.exp(-1j * omega * (0.5 * SAMPLE_S + 0.0083))
    expected = _linear_chain(truth).frequency_response([omega]).frdata[:, 0, 0] * held
    # a held sine's images at 1 kHz and the midpoint rule leave less than this
    np.testing.assert_allclose(measured, expected, rtol=2e-3, atol=1e-7)


def _linear_chain(truth: Truth) -> control.StateSpace:
    """Rotor, housing, wheel, vehicle, absorber: M x'' + D x' + K x = B u, from the springs' geometry."""
    p = {"has_mount": 0.0, "absorber_inertia": 0.0} | truth.parameters | truth.laws
    ratio, three = p["gear_ratio"], truth.kind == "three_inertia"
    masses = [
        p["motor_inertia"],
        p["housing_inertia"] if p["has_mount"] else 1e9,
        p["wheel_inertia"] if three else p["vehicle_inertia"],
        p["vehicle_inertia"] if three else 1.0,
        p["absorber_inertia"] or 1.0,
    ]
    shaft = np.array([1.0 / ratio, 1.0 - 1.0 / ratio, -1.0, 0.0, 0.0])
    springs = [(shaft, p["shaft_stiffness"], p["shaft_damping"])]
    if three:
        springs.append((np.array([0.0, 0, 1, -1, 0]), p["tyre_stiffness"], p["tyre_damping"]))
    if p["has_mount"]:
        springs.append((np.array([0.0, 1, 0, 0, 0]), p["mount_stiffness"], p["mount_damping"]))
    if p["absorber_inertia"]:
        springs.append((np.array([0.0, 0, 1, 0, -1]), p["absorber_stiffness"], p["absorber_damping"]))
    stiffness = sum(k * np.outer(g, g) for g, k, _ in springs)
    damping = sum(d * np.outer(g, g) for g, _, d in springs)
    inverse = np.diag(1.0 / np.array(masses))
    a = np.block([[np.zeros((5, 5)), np.eye(5)], [-inverse @ stiffness, -inverse @ damping]])
    b = np.concatenate([np.zeros(5), inverse @ [1.0, -1.0, 0.0, 0.0, 0.0]])[:, None]
    c = np.zeros((3, 10))
    c[0, 5:] = [1, -1, 0, 0, 0]
    c[1, 5:] = [0, 0, 1, 0, 0]
    c[2] = np.concatenate([p["shaft_stiffness"] * shaft, p["shaft_damping"] * shaft])
    return control.ss(a, b, c, np.zeros((3, 1)))


def test_energy_of_the_undamped_chain_is_kept():
    torque = np.zeros(6000)
    torque[:50] = 40.0
    _, out = true_outputs(Truth("two_inertia", TWO | {"shaft_damping": 0.0}), _open_loop(torque, 3.0))
    energy = (
        0.5 * 0.02 * out[:, 0] ** 2
        + 0.5 * 303.0 * out[:, 1] ** 2
        + 0.5 * out[:, 2] ** 2 / TWO["shaft_stiffness"]
    )
    free = energy[100:]
    assert np.ptp(out[100:, 2]) > 100.0
    assert np.ptp(free) < 1e-5 * (np.ptp(out[100:, 2]) / 2) ** 2 / TWO["shaft_stiffness"]


def test_bristles_settle_on_the_stribeck_curve():
    p = record({"coulomb": 2.0, "stribeck": 1.0, "stribeck_speed": 4.0, "friction_offset": 0.3})
    for speed in (-20.0, -2.0, 0.5, 4.0, 100.0):
        bristle = bristle_after(p, 0.0, speed, 10.0)
        curve = 2.0 + math.exp(-((speed / 4.0) ** 2))
        assert friction_torque(p, bristle, speed) == pytest.approx(math.copysign(curve, speed) + 0.3)


def test_friction_holds_small_torques_and_takes_its_part_of_large_ones():
    truth = Truth("rigid", RIGID, {"coulomb": 2.0})
    _, held = true_outputs(truth, _open_loop(np.full(3000, 1.9)))
    _, moved = true_outputs(truth, _open_loop(np.full(3000, 12.0)))
    assert abs(held[-1, 0]) < 1e-3
    slope = np.polyfit(np.arange(2000) * SAMPLE_S, moved[1000:, 0], 1)[0]
    assert slope == pytest.approx(10.0 / (0.02 + 300.0 / 64.0), rel=1e-4)


def test_friction_begins_settled_where_a_recording_begins_at_speed():
    truth = Truth("rigid", RIGID, {"coulomb": 2.0})
    _, out = true_outputs(truth, _open_loop(np.zeros(100), 20.0))
    np.testing.assert_allclose(out[:, 2], -2.0 * 8.0 * (300.0 / 64.0) / (0.02 + 300.0 / 64.0), rtol=1e-9)


def _bounce(force, mass, speed, gap):
    """Speed after a contact over speed before, with explicit steps of 1 µs."""
    x, v, h = gap, speed, 1e-6
    for _ in range(2_000_000):
        v -= h * force(x, v, h) / mass
        x += h * v
        if x < gap:
            return -v / speed
    raise AssertionError("never left the flank")


def test_restitution_of_a_dissipative_flank():
    # for small depths the law is Hunt and Crossley's with exponent 1: e = 1 - a v, damping = 1.5 a k depth
    a, k, depth, speed = 0.1, 1000.0, 10.0, 0.5
    p = record(
        {"shaft_stiffness": k, "shaft_damping": 1.5 * a * k * depth, "contact_depth": depth, "half_gap": 0.01}
    )
    e = _bounce(lambda x, v, h: shaft_torque(p, x, v, 0.0), 1.0, speed, 0.01)
    assert e == pytest.approx(1.0 - a * speed, abs=0.004)


def test_restitution_of_flanks_in_series_with_the_shafts():
    mass, k, zeta, gap = 1.0, 6000.0, 0.1, 0.01
    p = record({"shaft_stiffness": k, "shaft_damping": 2 * zeta * math.sqrt(k * mass), "half_gap": gap})
    state = [0.0]

    def force(x, v, h):
        state[0], torque = series_contact(p, state[0], x - v * h, v, h)
        return torque

    root = math.sqrt(1 - zeta**2)
    angle = math.pi - math.atan2(2 * zeta * root, 1 - 2 * zeta**2)
    # a spring and damper that part when their force is zero
    expected = math.exp(-zeta / root * angle) * (zeta / root * math.sin(angle) - math.cos(angle))
    x, v, h = gap, 0.5, 1e-6
    left = False
    for _ in range(2_000_000):
        torque = force(x, v, h)
        v -= h * torque / mass
        x += h * v
        if v < 0.0 and torque == 0.0:
            left = True
            break
    assert left
    assert -v / 0.5 == pytest.approx(expected, abs=0.01)


def test_free_play_holds_no_torque_inside_and_is_continuous_towards_none():
    torque = 20.0 * np.sin(2 * math.pi * 6.0 * np.arange(3000) * SAMPLE_S)
    _, none = true_outputs(Truth("two_inertia", TWO), _open_loop(torque))
    _, tiny = true_outputs(Truth("two_inertia", TWO, {"half_gap": 1e-6}), _open_loop(torque))
    _, wide = true_outputs(Truth("two_inertia", TWO, {"half_gap": 0.01}), _open_loop(torque))
    scale = np.std(none, axis=0)
    assert np.all(np.std(tiny - none, axis=0) < 0.01 * scale)
    assert np.mean(wide[500:, 2] == 0.0) > 0.02


@pytest.mark.parametrize("amplitude", [1.0, 3.0])
def test_loop_area_of_bouc_wen(amplitude):
    slip, stiffness = 0.01, 500.0
    p = record(
        {
            "hysteresis": BOUC_WEN,
            "hysteresis_stiffness": stiffness,
            "hysteresis_slip": slip,
            "hysteresis_sharpness": 1.0,
        }
    )
    area = _loop_area(p, amplitude * slip)
    top = amplitude
    for _ in range(200):  # where the branch 1 - exp(-s) ends, s = 2a - top
        top = 1.0 - math.exp(-(2.0 * amplitude - top))
    expected = 2.0 * ((2.0 * amplitude - top) - top - 0.5 * top**2) * stiffness * slip**2
    assert area == pytest.approx(expected, rel=2e-3)


def test_loop_area_of_masing_elements():
    slip, stiffness, amplitude = 0.01, 500.0, 0.04
    p = record({"hysteresis": MASING, "hysteresis_stiffness": stiffness, "hysteresis_slip": slip})
    slips = slip * (0.5 + (np.arange(ELEMENTS) + 0.5) / ELEMENTS)
    expected = np.sum(4.0 * stiffness / ELEMENTS * slips * (amplitude - slips))
    assert _loop_area(p, amplitude) == pytest.approx(expected, rel=2e-3)


def _loop_area(p, amplitude):
    """Work per cycle in J of the third cycle of a slow triangle."""
    state, after = np.zeros(ELEMENTS), np.zeros(ELEMENTS)
    quarter, work = 4000, 0.0
    directions = np.concatenate([np.ones(quarter), np.tile([-1.0] * 2 * quarter + [1.0] * 2 * quarter, 3)])
    step, before = amplitude / quarter, 0.0
    for number, sign in enumerate(directions):
        torque = advance(p, state, after, sign, step)
        state[:] = after
        if number >= len(directions) - 4 * quarter:
            work += 0.5 * (before + torque) * sign * step
        before = torque
    return work


def test_dead_time_shares_a_step_between_two_requests():
    ref = np.array([1.0, 3.0])
    assert delayed(ref, -0.5e-3, -0.4e-3, 1e-3) == 0.0
    assert delayed(ref, 0.9e-3, 1.1e-3, 1e-3) == pytest.approx(2.0)
    assert delayed(ref, 0.95e-3, 1.15e-3, 1e-3) == pytest.approx(0.25 * 1.0 + 0.75 * 3.0)


def test_torque_path_limits():
    p = record({"limit_nm": 10.0, "rate_nm_s": 1e3, "deadband_nm": 2.0})
    torques, torque, lagged = [], 0.0, 0.0
    for _ in range(30):
        lagged, torque = acting(p, 30.0, lagged, torque, 0.0, 1e-3)
        torques.append(torque)
    assert torques[:3] == pytest.approx([1.0, 2.0, 3.0])
    assert torques[-1] == pytest.approx(10.0)
    assert acting(p, -1.5, 0.0, 0.0, 0.0, 1e-3)[1] == 0.0
    slow = record({"lag_s": 0.02})
    lagged = 0.0
    for _ in range(20):
        lagged, torque = acting(slow, 5.0, lagged, 0.0, 0.0, 1e-3)
    assert torque == pytest.approx(5.0 * (1.0 - math.exp(-1.0)))


def test_sensors_and_noise():
    ramp = np.stack([np.linspace(0.0, 1.0, 1001)] * 3, axis=1)
    truth = Truth(
        "rigid", RIGID, {}, (Sensor("motor_speed_rad_s", 2.0, 0.5, 0.1), Sensor("shaft_torque_nm", step=0.25))
    )
    shown = read_by_sensors(truth, ramp, np.zeros_like(ramp))
    assert shown[600, 0] == pytest.approx(2.0 * 0.5 + 0.5)
    assert set(shown[:, 2]) == {0.0, 0.25, 0.5, 0.75, 1.0}
    noise = coloured_noise(
        np.random.default_rng(1), 200_000, 3.0, share=0.2, corner_hz=5.0, rate_hz=1.0 / SAMPLE_S
    )
    assert np.std(noise) == pytest.approx(3.0, rel=0.02)


def test_the_set_is_seven_recordings_of_196_seconds():
    experiments = main_set(np.random.default_rng(1), 1.0)
    assert len(experiments) == 7
    assert sum(e.duration_s for e in experiments) == pytest.approx(196.0)
    assert all(e.torque_nm[0] == pytest.approx(0.0) for e in experiments)
    assert not {e.name for e in experiments} & {e.name for e in holdout_set(np.random.default_rng(1), 1.0)}


def test_a_closed_loop_holds_the_wheel_speed_against_a_load():
    rest = np.zeros(30_000)
    experiment = Experiment("test", rest, np.full(30_000, 10.0), 10.0, closed_loop=True)
    request, out = true_outputs(Truth("three_inertia", THREE, {"rolling": 60.0}), experiment)
    assert out[-1, 1] == pytest.approx(10.0, rel=0.02)
    assert request[-1] == pytest.approx(60.0 / 8.148, rel=0.1)
