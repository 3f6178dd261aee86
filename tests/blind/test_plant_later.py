"""Slipping tyre, late dyno, turning friction, damped flanks: closed forms and another integrator."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pytest
from scipy.integrate import solve_ivp

from tests.blind.experiments import SAMPLE_S, Experiment
from tests.blind.later_families import restitution_of, turn_of
from tests.blind.plant import Truth, true_outputs
from tests.blind.reference.contact import series_contact, shaft_torque
from tests.blind.reference.friction import bristle_after, friction_torque
from tests.blind.reference.layout import Constants, record
from tests.blind.reference.tyre import CELLS, angle_behind, patch_after
from tests.blind.sensors import Sensor

Array = npt.NDArray[np.float64]

THREE = {
    "motor_inertia": 0.02,
    "gear_ratio": 8.148,
    "shaft_stiffness": 6089.0,
    "shaft_damping": 19.75,
    "wheel_inertia": 4.355,
    "tyre_stiffness": 5717.0,
    "tyre_damping": 351.0,
    "vehicle_inertia": 303.0,
    "torque_delay": 0.0,
}
#: slip stiffness in N m, relaxation length in m
SLIP = {"slip_stiffness": 5000.0, "relaxation_length": 0.3}


def _open_loop(torque_nm: Array, wheel_speed: float = 0.0) -> Experiment:
    return Experiment("test", torque_nm, np.zeros_like(torque_nm), wheel_speed)


def _rolled(p: Constants, sliding: float, rolling: float, distance_m: float, steps: int = 4000) -> Array:
    """Torque of the patch along the way, from rest."""
    state, after, torques = np.zeros(CELLS), np.zeros(CELLS), np.empty(steps)
    span_s = distance_m / abs(rolling) / steps
    for i in range(steps):
        torques[i] = patch_after(p, state, after, sliding, rolling, span_s)
        state[:] = after
    return torques


@pytest.mark.parametrize("cells", [1, 2, 4])
@pytest.mark.parametrize("rolling", [6.0, -6.0])
def test_a_slipping_tyre_settles_at_its_slip_stiffness(cells: int, rolling: float) -> None:
    p = record(SLIP | {"patch_cells": cells})
    torque = _rolled(p, 0.12, rolling, 6.0)[-1]
    assert torque == pytest.approx(5000.0 * 0.12 / 6.0, rel=1e-6)


@pytest.mark.parametrize("cells", [1, 2, 4])
def test_a_tyre_at_rest_is_a_spring(cells: int) -> None:
    p = record(SLIP | {"patch_cells": cells})
    torque = patch_after(p, np.zeros(CELLS), np.zeros(CELLS), 0.33 * 0.5, 0.0, 0.01)
    assert torque == pytest.approx(5000.0 * 0.33 / 0.3 * 0.005)


def test_the_force_of_one_cell_builds_up_over_the_relaxation_length() -> None:
    torques = _rolled(record(SLIP), 0.12, 6.0, 0.6)
    way = 0.6 * np.arange(1, 4001) / 4000
    np.testing.assert_allclose(torques, 100.0 * -np.expm1(-way / 0.3), atol=1e-5)


def test_the_patch_gives_no_energy_back_beyond_what_it_was_given() -> None:
    p = record(SLIP | {"patch_cells": 4})
    state, after, work, least = np.zeros(CELLS), np.zeros(CELLS), 0.0, 0.0
    for i in range(20_000):
        slip = 0.4 * math.sin(0.003 * i) + 0.2 * math.sin(0.0171 * i)
        torque = patch_after(p, state, after, 0.33 * slip, 3.0 * math.cos(0.0007 * i), 1e-3)
        state[:] = after
        work += torque * slip * 1e-3
        least = min(least, work)
    assert work > 1.0
    assert least > -1e-3 * work


def test_a_late_dyno_is_behind_by_its_time_constant_times_the_speed() -> None:
    p = record({"dyno_lag_s": 0.02})
    assert angle_behind(p, 0.0, 5.0, 10.0) == pytest.approx(0.02 * 5.0)
    assert angle_behind(p, 0.0, 5.0, 0.02) == pytest.approx(0.1 * (1.0 - math.exp(-1.0)))
    # in steps or at once: the same
    half = angle_behind(p, 0.03, 5.0, 0.004)
    assert angle_behind(p, half, 5.0, 0.004) == pytest.approx(angle_behind(p, 0.03, 5.0, 0.008))


def _wobble(time_s: float) -> float:
    """A motor torque in N m that turns around."""
    return 25.0 * math.sin(2.0 * math.pi * 1.7 * time_s) + 12.0 * math.sin(2.0 * math.pi * 7.0 * time_s)


def _by_the_contract(laws: dict[str, float]) -> Callable[[float, Array], Array]:
    """The laws as the list of effects writes them down; state: see `_reference`."""
    q = THREE
    slip, relaxation = laws.get("slip_stiffness", 0.0), laws.get("relaxation_length", 1.0)
    late = laws.get("dyno_lag_s", 0.0)
    dry, turn = laws.get("coulomb", 0.0), laws.get("turn", 1.0)

    def rates(time_s: float, y: Array) -> Array:
        twist, rotor, wheel, vehicle, tyre, dyno, friction = y
        rate = rotor / q["gear_ratio"] - wheel
        shaft = q["shaft_stiffness"] * twist + q["shaft_damping"] * rate
        road = dyno if late else vehicle
        passed = tyre + q["tyre_damping"] * (wheel - road)
        if slip:
            tyre_rate = 0.33 / relaxation * (slip * (wheel - road) - abs(road) * tyre)
        else:
            tyre_rate = q["tyre_stiffness"] * (wheel - road)
        turned = (dry - math.copysign(1.0, rotor) * friction) / turn * rotor
        return np.array(
            [
                rate,
                (_wobble(time_s) - friction - shaft / q["gear_ratio"]) / q["motor_inertia"],
                (shaft - passed) / q["wheel_inertia"],
                passed / q["vehicle_inertia"],
                tyre_rate,
                (vehicle - dyno) / late if late else 0.0,
                turned,
            ]
        )

    return rates


def _reference(laws: dict[str, float], wheel_speed: float, samples: int) -> Array:
    """Outputs by scipy, the torque held over each sample: the request is a staircase."""
    start = [0.0, wheel_speed * THREE["gear_ratio"], wheel_speed, wheel_speed, 0.0, wheel_speed, 0.0]
    if wheel_speed != 0.0:
        start[6] = math.copysign(laws.get("coulomb", 0.0), wheel_speed)
    solved = solve_ivp(
        _by_the_contract(laws),
        (0.0, samples * SAMPLE_S),
        start,
        t_eval=np.arange(samples) * SAMPLE_S,
        rtol=1e-8,
        atol=1e-9,
        max_step=0.002,
    )
    twist, rotor, wheel = solved.y[:3]
    torque = THREE["shaft_stiffness"] * twist + THREE["shaft_damping"] * (rotor / THREE["gear_ratio"] - wheel)
    return np.stack([rotor, wheel, torque], axis=1)


@pytest.mark.parametrize(
    ("laws", "contract", "wheel_speed"),
    [
        (SLIP, SLIP, 8.0),
        (SLIP, SLIP, 0.0),
        (SLIP | {"relaxation_length": 3.0}, SLIP | {"relaxation_length": 3.0}, -5.0),
        ({"dyno_lag_s": 0.02}, {"dyno_lag_s": 0.02}, 3.0),
        (SLIP | {"dyno_lag_s": 0.01}, SLIP | {"dyno_lag_s": 0.01}, 3.0),
        (
            {"coulomb": 2.0, "bristle_stiffness": 10.0, "bristle_damping": 0.0},
            {"coulomb": 2.0, "turn": 0.2},
            1.0,
        ),
    ],
    ids=["slip", "slip from rest", "slip backwards", "late dyno", "both", "turning friction"],
)
def test_the_plant_agrees_with_another_integrator_of_the_contracts_laws(
    laws: dict[str, float], contract: dict[str, float], wheel_speed: float
) -> None:
    samples = 1000
    # a held request, advanced by half a sample, is the smooth torque up to the second order
    torque = np.array([_wobble((k + 0.5) * SAMPLE_S) for k in range(samples)])
    _, out = true_outputs(Truth("three_inertia", THREE, laws), _open_loop(torque, wheel_speed))
    expected = _reference(contract, wheel_speed, samples)
    size = np.std(expected, axis=0)
    assert np.all(np.max(np.abs(out - expected), axis=0) < 1e-3 * size)


@pytest.mark.parametrize(
    ("nearly", "without"),
    [
        ({"slip_stiffness": 5717.0 * 1e4 / 0.33, "relaxation_length": 1e4}, {}),
        ({"dyno_lag_s": 1e-6}, {}),
        ({"half_gap": 0.01, "contact_damping": 1e-6}, {"half_gap": 0.01}),
        (
            {"coulomb": 2.0, "bristle_exponent": 1.0 + 1e-7, "bristle_damping": 0.0},
            {"coulomb": 2.0, "bristle_damping": 0.0},
        ),
    ],
    ids=["long relaxation", "prompt dyno", "no damping", "Dahl's exponent 1"],
)
def test_effects_vanish_with_their_size(nearly: dict[str, float], without: dict[str, float]) -> None:
    torque = np.array([_wobble(k * SAMPLE_S) for k in range(1500)])
    outputs = [
        true_outputs(Truth("three_inertia", THREE, laws), _open_loop(torque, 4.0))[1]
        for laws in (nearly, without)
    ]
    assert np.all(np.std(outputs[0] - outputs[1], axis=0) < 2e-4 * np.std(outputs[1], axis=0))


@pytest.mark.parametrize("exponent", [0.7, 1.0, 1.3])
def test_friction_turns_around_as_dahl_wrote_it(exponent: float) -> None:
    dry, stiffness = 2.0, 10.0
    p = record(
        {
            "coulomb": dry,
            "bristle_stiffness": stiffness,
            "bristle_exponent": exponent,
            "bristle_damping": 0.0,
        }
    )
    steps, turned, bristle = 4000, 12.0, -dry / stiffness
    torques = np.empty(steps)
    for i in range(steps):
        bristle = bristle_after(p, bristle, 2.0, turned / steps / 2.0)
        torques[i] = friction_torque(p, bristle, 2.0)
    angles = turned * np.arange(1, steps + 1) / steps
    dahl = solve_ivp(
        lambda _, torque: stiffness * max(1.0 - torque[0] / dry, 0.0) ** exponent,
        (0.0, turned),
        [-dry],
        t_eval=angles,
        rtol=1e-9,
        atol=1e-9,
    )
    np.testing.assert_allclose(torques, dahl.y[0], atol=1e-5)
    # what a reversal saves of the work is told by the angle over which friction turns
    saved = np.trapezoid(dry - torques, angles) + (dry - torques[0]) * angles[0]
    missing = 1.0 - torques[-1] / dry  # a power above 1 has a long tail
    tail = dry**2 / stiffness * missing ** (2.0 - exponent) / (2.0 - exponent)
    assert saved + tail == pytest.approx(2.0 * dry * turn_of(dry, stiffness, exponent), rel=1e-3)


def _parting_speed(
    force: Callable[[float, float, float], float], gap: float, speed: float, h: float
) -> float:
    """Speed of 1 kg m² when flanks, closed at `speed`, no longer push; steps of `h` s."""
    x, v = gap, speed
    for _ in range(100_000):
        torque = force(x, v, h)
        v -= h * torque
        x += h * v
        if v < 0.0 and torque == 0.0:
            return -v
    raise AssertionError("never left the flank")


@pytest.mark.parametrize("ratio", [0.05, 0.2, 0.4])
def test_flanks_part_with_the_restitution_that_their_damping_means(ratio: float) -> None:
    stiffness = 6000.0
    p = record(
        {
            "shaft_stiffness": stiffness,
            "shaft_damping": 0.05,
            "half_gap": 0.01,
            "contact_depth": 1e-9,
            "contact_damping": 2.0 * ratio * math.sqrt(stiffness),
        }
    )
    wound = 0.0

    def in_series(x: float, v: float, h: float) -> float:
        nonlocal wound
        wound, torque = series_contact(p, wound, x - v * h, v, h)
        return float(torque)

    expected = restitution_of(ratio)
    assert _parting_speed(in_series, 0.01, 0.5, 2e-6) / 0.5 == pytest.approx(expected, abs=0.015)
    alone = _parting_speed(lambda x, v, h: float(shaft_torque(p, x, v, 0.0)), 0.01, 0.5, 2e-6)
    assert alone / 0.5 == pytest.approx(expected, abs=0.01)


@pytest.mark.parametrize("form", [1.0, 2.0])
def test_damped_flanks_never_pull_and_take_energy(form: float) -> None:
    torque = np.array([_wobble(k * SAMPLE_S) for k in range(2000)])
    hard, soft = (
        true_outputs(
            Truth(
                "three_inertia",
                THREE | {"shaft_damping": 0.5},
                {"half_gap": 0.01, "contact_form": form, "contact_depth": 2e-4, "contact_damping": damping},
            ),
            _open_loop(torque),
        )[1]
        for damping in (0.0, 60.0)
    )
    # a pull would turn the torque around before the other flank is met
    signs = np.sign(soft[:, 2])
    assert not np.any(signs[1:] * signs[:-1] < 0.0)
    assert np.mean(soft[500:, 2] ** 2) < np.mean(hard[500:, 2] ** 2)


def test_squeeze_damping_takes_energy_by_the_cube_of_the_amplitude() -> None:
    p = record({"squeeze_damping": 3.0})
    phase = np.linspace(0.0, 2.0 * math.pi, 2001)
    works = []
    for amplitude in (0.01, 0.02):
        twist, rate = amplitude * np.sin(phase), 40.0 * amplitude * np.cos(phase)
        torque = [shaft_torque(p, x, v, 0.0) for x, v in zip(twist, rate, strict=True)]
        works.append(np.trapezoid(torque, twist))
    assert works[0] == pytest.approx(8.0 / 3.0 * 3.0 * 40.0**2 * 0.01**3, rel=1e-4)
    assert works[1] == pytest.approx(8.0 * works[0], rel=1e-6)


@pytest.mark.parametrize("hertz", [0.5, 8.0, 30.0])
def test_a_low_passed_channel_has_the_gain_and_phase_of_the_formula(hertz: float) -> None:
    time_s, omega, lag_s = np.arange(8000) * SAMPLE_S, 2.0 * math.pi * hertz, 0.006
    truth = np.sin(omega * time_s)
    found = Sensor("motor_speed_rad_s", gain=2.0, lag_s=lag_s).read(truth, SAMPLE_S)
    wanted = 2.0 * np.imag(np.exp(1j * omega * time_s) / (1.0 + 1j * omega * lag_s))
    np.testing.assert_allclose(found[200:], wanted[200:], atol=2e-4)
