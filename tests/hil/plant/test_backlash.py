"""Free play against closed forms, and one kernel against the other."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from hil.core.model import EffectUse, Model
from hil.plant import Start, ideal_sensors, pack, simulate, simulate_many
from tests.blind.experiments import Experiment
from tests.blind.plant import Truth, true_outputs

PLAIN = Model(
    kind="two_inertia",
    parameters={
        "motor_inertia": 0.02,
        "gear_ratio": 7.0,
        "shaft_stiffness": 6000.0,
        "shaft_damping": 20.0,
        "vehicle_inertia": 300.0,
        "torque_delay": 0.008,
    },
)


def with_gap(half_gap_rad: float) -> Model:
    return PLAIN.with_effects(EffectUse("backlash", {"half_gap_rad": half_gap_rad}))


def chirp(seconds: float = 8.0) -> np.ndarray:
    t = np.arange(0.0, seconds, 1e-3)
    return 25.0 * np.sin(2 * np.pi * (0.5 * t + 0.7 * t**2))


def many(model: Model, torque: np.ndarray, start: tuple[float, float, float]) -> np.ndarray:
    return simulate_many(pack(model)[None], torque, 1e-3, np.array([start]), ideal_sensors(1))[0]


def one(model: Model, torque: np.ndarray, start: tuple[float, float, float]) -> np.ndarray:
    out = simulate(model, torque, 1e-3, start=Start(*start))
    return np.column_stack(
        [out[name] for name in ("motor_speed_rad_s", "wheel_speed_rad_s", "shaft_torque_nm")]
    )


@pytest.mark.parametrize("kernel", [one, many])
def test_a_vanishing_gap_leaves_the_shaft(kernel):
    torque = chirp()
    plain, played = (kernel(m, torque, (0.0, 0.0, 0.0)) for m in (PLAIN, with_gap(1e-7)))
    rms = np.sqrt(np.mean((played - plain) ** 2, axis=0)) / np.std(plain, axis=0)
    assert np.all(rms < 2e-3)


def test_both_kernels_see_the_same_gap():
    torque = chirp()
    a, b = (kernel(with_gap(0.003), torque, (0.0, 0.0, 60.0)) for kernel in (one, many))
    rms = np.sqrt(np.mean((a - b) ** 2, axis=0)) / np.std(a, axis=0)
    assert np.all(rms < 0.02)


@pytest.mark.parametrize("half_gap_rad", [0.0005, 0.005])
@pytest.mark.parametrize(
    "flanks",
    [{}, {"tension": 0.5}, {"tension": 1.0}, {"tension": 1.0, "depth_damping_nms_rad2": 400.0}],
    ids=["let go", "pull half", "pull", "damped by depth"],
)
def test_steps_of_a_sample_see_where_within_one_flanks_meet_and_part(flanks, half_gap_rad):
    """The same model in steps a twentieth as long is another one by less than a thousandth."""
    assert np.all(off_by_steps(flanks, half_gap_rad) < 1e-3)


@pytest.mark.parametrize("half_gap_rad", [0.0005, 0.005])
@pytest.mark.parametrize("flanks", [{"contact_damping_nms_rad": 10.0}, {"one_spring": 1.0}])
def test_steps_of_a_sample_see_a_damping_that_sets_in_within_one(flanks, half_gap_rad):
    """Its rise goes straight through the step in which flanks meet: three thousandths."""
    assert np.all(off_by_steps({**flanks, "contact_depth_rad": 1e-3}, half_gap_rad) < 3e-3)


def off_by_steps(flanks, half_gap_rad):
    """How far speeds are off those of steps a twentieth as long, of their standard deviation."""
    model = PLAIN.with_effects(EffectUse("backlash", {"half_gap_rad": half_gap_rad, **flanks}))
    torque, start = chirp(6.0), np.zeros((1, 3))
    coarse = simulate_many(pack(model)[None], torque, 1e-3, start, ideal_sensors(1))[0]
    often = np.repeat(torque, 20)
    fine = simulate_many(pack(model)[None], often, 5e-5, start, ideal_sensors(1))[0, ::20]
    rms = np.sqrt(np.mean((coarse - fine) ** 2, axis=0)) / np.std(fine, axis=0)
    return rms[:2]


@pytest.mark.parametrize("kernel", [one, many])
def test_nothing_is_carried_while_the_rotor_crosses_the_gap(kernel):
    """Closed form: from the middle of the gap, at rest, a constant torque needs sqrt(2·J·n·gap / T)."""
    torque = np.full(400, 0.5)
    shaft = kernel(with_gap(0.02), torque, (0.0, 0.0, 0.0))[:, 2]
    crossing = np.sqrt(2 * 0.02 * 7.0 * 0.02 / 0.5)
    # the first value has acted since long before: no dead time at the start
    first = int(np.argmax(shaft > 0.05)) * 1e-3
    assert np.all(shaft[: int(1e3 * crossing) - 2] < 1e-9)
    assert first == pytest.approx(crossing, abs=3e-3)


@pytest.mark.parametrize("kernel", [one, many])
def test_contact_never_pulls(kernel):
    """A rotor thrown off keeps its speed until the other end of the gap is there."""
    start = (14.0, 0.0, -50.0)
    out = kernel(with_gap(0.02), np.zeros(100), start)
    free = out[2:12]
    assert np.all(free[:, 2] < 1e-9)
    lost = np.flatnonzero(np.abs(out[:, 2]) < 1e-9)
    assert lost.size > 5
    assert np.ptp(out[lost[1:5], 0]) < 1e-3


@pytest.mark.slow
@pytest.mark.parametrize(("form", "one_spring"), [(1.0, 0.0), (2.0, 1.0)], ids=["in series", "one spring"])
def test_flanks_of_another_author_need_the_depth_over_which_their_damping_sets_in(form, one_spring):
    """By another integrator, 40 steps a sample, and with another rise: depth / (depth + 2e-4 rad)."""
    laws = {"half_gap": 0.001, "contact_form": form, "contact_depth": 2e-4, "contact_damping": 15.0}
    torque = chirp(12.0)
    experiment = Experiment("test", torque, np.zeros_like(torque))
    theirs = true_outputs(Truth(PLAIN.kind, dict(PLAIN.parameters), laws), experiment)[1]
    at_once: dict[str, float | str] = {"half_gap_rad": 0.001, "contact_damping_nms_rad": 15.0}
    over_depth = at_once | {"contact_depth_rad": 6e-4, "one_spring": one_spring}
    off = [
        np.std(many(PLAIN.with_effects(EffectUse("backlash", law)), torque, (0.0, 0.0, 0.0)) - theirs, axis=0)
        for law in (at_once, over_depth)
    ]
    assert np.all(off[1] < 0.5 * off[0])
    assert np.all(off[1] < 0.02 * np.std(theirs, axis=0))


@pytest.mark.parametrize("kernel", [one, many])
@pytest.mark.parametrize("flanks", ["one_spring", "film"])
def test_dead_zones_of_other_authors_are_those_of_a_library_for_differential_equations(kernel, flanks):
    """With one spring the dead zone never pulls; with a film the damping acts in the gap as well."""
    p, gap = PLAIN.parameters, 0.004
    n, k, d = p["gear_ratio"], p["shaft_stiffness"], p["shaft_damping"]
    request = chirp(4.0)
    late = np.concatenate([np.full(8, request[0]), request])  # dead time of eight samples

    def shaft(twist, rate):
        beyond = twist - np.clip(twist, -gap, gap)
        if flanks == "film":
            return k * beyond + d * rate
        return np.sign(beyond) * max(np.sign(beyond) * (k * beyond + d * rate), 0.0)

    def slope(t, x):
        twist, rotor, wheel = x
        rate = rotor / n - wheel
        torque = shaft(twist, rate)
        return (
            rate,
            (late[int(t * 1e3 + 1e-6)] - torque / n) / p["motor_inertia"],
            torque / p["vehicle_inertia"],
        )

    times, x, expected = np.arange(4000) * 1e-3, np.zeros(3), np.zeros((4000, 2))
    for index, t in enumerate(times):
        expected[index] = x[1:]
        x = solve_ivp(slope, (t, t + 9.99e-4), x, rtol=1e-8, atol=1e-9, max_step=1e-4).y[:, -1]
    model = PLAIN.with_effects(EffectUse("backlash", {"half_gap_rad": gap, flanks: 1.0}))
    got = kernel(model, request, (0.0, 0.0, 0.0))[:, :2]
    assert np.all(np.std(got - expected, axis=0) < 0.01 * np.std(expected, axis=0))
