"""The kernel against closed forms, exact discretisation by scipy, and python-control."""

from pathlib import Path

import control
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil.core.errors import BadInputError
from hil.core.model import EffectUse, Model, load_model
from hil.core.recording import Recording
from hil.plant import Start, pack, replay, simulate

BENCHES = Path(__file__).parents[3] / "benches"
THREE = load_model(BENCHES / "three_inertia.toml").with_effects()
P = THREE.parameters
TWO = Model(
    "two_inertia",
    {name: P[name] for name in ("motor_inertia", "gear_ratio", "shaft_stiffness", "shaft_damping")}
    | {"vehicle_inertia": 307.0, "torque_delay": 0.008},
)
RIGID = Model(
    "rigid",
    {
        "motor_inertia": 0.02,
        "gear_ratio": 8.0,
        "vehicle_inertia": 300.0,
        "viscous_drag": 0.05,
        "torque_delay": 0.0,
    },
)
DT = 1e-3


def step(samples=3000, at=100, height=20.0):
    torque = np.zeros(samples)
    torque[at:] = height
    return torque


def state_space(model: Model) -> control.StateSpace:
    """Equations of motion of the chain, written down anew: outputs ω_m, ω_l, T_s."""
    p = model.parameters
    j, n, k, d = p["motor_inertia"], p["gear_ratio"], p["shaft_stiffness"], p["shaft_damping"]
    if model.kind == "two_inertia":
        jv = p["vehicle_inertia"]
        a = [
            [-d / (j * n * n), -k / (j * n), d / (j * n)],
            [1 / n, 0, -1],
            [d / (jv * n), k / jv, -d / jv],
        ]
        c = [[1, 0, 0], [0, 0, 1], [d / n, k, -d]]
        return control.ss(a, [[1 / j], [0], [0]], c, np.zeros((3, 1)))
    jw, jv, kt, dt = p["wheel_inertia"], p["vehicle_inertia"], p["tyre_stiffness"], p["tyre_damping"]
    a = [
        [-d / (j * n * n), -k / (j * n), d / (j * n), 0, 0],
        [1 / n, 0, -1, 0, 0],
        [d / (jw * n), k / jw, -(d + dt) / jw, -kt / jw, dt / jw],
        [0, 0, 1, 0, -1],
        [0, 0, dt / jv, kt / jv, -dt / jv],
    ]
    c = [[1, 0, 0, 0, 0], [0, 0, 1, 0, 0], [d / n, k, -d, 0, 0]]
    return control.ss(a, [[1 / j], [0], [0], [0], [0]], c, np.zeros((3, 1)))


@pytest.mark.parametrize("model", [TWO, THREE], ids=lambda m: m.kind)
@pytest.mark.parametrize("delay", [0.0, 0.008, 0.00834, 0.0005])
def test_linear_chains_agree_with_python_control(model, delay):
    model = model.with_parameters(torque_delay=delay)
    fine = 1e-5  # python-control has no dead time: shift a torque that is sampled finely enough
    samples = 1200
    torque = step(samples, 100) + 5.0 * (np.arange(samples) > 700)
    time = np.arange(samples * 100) * fine
    shifted = torque[np.clip(((time - delay) / DT + 1e-6).astype(int), 0, None)] * (time >= delay)
    discrete = control.c2d(state_space(model), fine, "zoh")
    _, expected = control.forced_response(discrete, time, shifted)
    got = simulate(model, torque, DT)
    for row, name in enumerate(("motor_speed_rad_s", "wheel_speed_rad_s", "shaft_torque_nm")):
        scale = np.max(np.abs(expected[row]))
        np.testing.assert_allclose(got[name], expected[row, ::100], atol=1e-9 * scale)


def test_rigid_model_is_the_closed_form():
    inertia = 0.02 + 300.0 / 64.0
    got = simulate(RIGID, step(at=0), DT)
    time = np.arange(3000) * DT
    speed = 20.0 / 0.05 * (1 - np.exp(-0.05 / inertia * time))
    np.testing.assert_allclose(got["motor_speed_rad_s"], speed, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(got["wheel_speed_rad_s"], speed / 8.0, rtol=1e-12, atol=1e-12)
    # T_s is the torque that the load needs
    np.testing.assert_allclose(
        got["shaft_torque_nm"], 300.0 / 8.0 * (20.0 - 0.05 * speed) / inertia, rtol=1e-8
    )


@given(
    frequency=st.floats(0.5, 25.0),
    model=st.sampled_from([TWO, THREE]),
)
def test_a_sine_comes_out_with_the_frequency_responses_gain_and_phase(frequency, model):
    omega = 2 * np.pi * frequency
    samples = 8000
    torque = np.sin(omega * np.arange(samples) * DT)
    got = simulate(model, torque, DT)["shaft_torque_nm"][-4000:]
    hold = np.exp(-0.5j * omega * DT) * np.sinc(frequency * DT) * np.exp(-1j * omega * 0.008)
    expected = state_space(model)(1j * omega)[2, 0] * hold
    time = np.arange(samples)[-4000:] * DT
    basis = np.column_stack([np.sin(omega * time), np.cos(omega * time), np.ones_like(time)])
    a, b, _ = np.linalg.lstsq(basis, got, rcond=None)[0]
    assert complex(a, b) == pytest.approx(expected, rel=2e-3)


def test_the_papers_functions_agree_with_python_control():
    model = load_model(BENCHES / "paper_functions.toml")
    torque = step(2000, 50)
    got = simulate(model, torque, DT)
    time = np.arange(2000) * DT
    shifted = np.concatenate([np.zeros(8), torque[:-8]])
    for name, function in model.transfer_functions.items():
        plant = control.c2d(control.ss(control.tf(function.numerator, function.denominator)), DT, "zoh")
        _, expected = control.forced_response(plant, time, shifted)
        np.testing.assert_allclose(got[name], expected, atol=1e-12 * np.max(np.abs(expected)))


def test_transfer_function_dead_time_need_not_be_a_whole_sample():
    model = load_model(BENCHES / "paper_functions.toml")
    function = model.transfer_functions["motor_speed_rad_s"]
    half = type(function)(function.numerator, function.denominator, 0.0085)
    moved = Model("transfer_function", {}, (), {"motor_speed_rad_s": half})
    at_half = simulate(moved, step(), 1e-3)["motor_speed_rad_s"]
    finer = simulate(moved, np.repeat(step(), 2), 5e-4)["motor_speed_rad_s"][::2]
    np.testing.assert_allclose(at_half, finer, atol=1e-11)


def test_initial_speeds_are_kept_without_torque():
    got = simulate(THREE, np.zeros(1000), DT, Start(20.0 * P["gear_ratio"], 20.0))
    np.testing.assert_allclose(got["wheel_speed_rad_s"], 20.0, rtol=1e-9)
    np.testing.assert_allclose(got["motor_speed_rad_s"], 20.0 * P["gear_ratio"], rtol=1e-9)


@given(scale=st.floats(-30, 30))
def test_without_effects_the_chain_is_linear(scale):
    torque = step(600)
    one = simulate(THREE, torque, DT)["shaft_torque_nm"]
    many = simulate(THREE, scale * torque, DT)["shaft_torque_nm"]
    np.testing.assert_allclose(many, scale * one, atol=1e-13 * max(1.0, abs(scale)) * np.max(np.abs(one)))


def with_effect(model, effect, **values):
    return model.with_effects(EffectUse(effect, values))


def test_an_impulse_of_torque_ends_as_momentum():
    torque = np.zeros(6000)
    torque[10:110] = 50.0
    got = simulate(THREE, torque, DT)
    total = P["motor_inertia"] * P["gear_ratio"] ** 2 + P["wheel_inertia"] + P["vehicle_inertia"]
    expected = P["gear_ratio"] * 50.0 * 0.1 / total
    np.testing.assert_allclose(got["wheel_speed_rad_s"][-1000:], expected, rtol=1e-6)


class TestEffects:
    def test_dead_time_adds_to_the_models(self):
        late = simulate(with_effect(THREE, "dead_time", extra_delay_s=0.0123), step(), DT)
        same = simulate(THREE.with_parameters(torque_delay=0.0203), step(), DT)
        np.testing.assert_allclose(late["motor_speed_rad_s"], same["motor_speed_rad_s"], rtol=1e-12)

    def test_lag_is_a_first_order_lag(self):
        got = simulate(with_effect(RIGID, "actuator_lag", time_constant_s=0.05), step(at=1), DT)
        time = np.arange(2999) * DT
        expected = 20.0 * (1 - np.exp(-time / 0.05))
        np.testing.assert_allclose(got["motor_torque_nm"][1:], expected, atol=1e-8)

    def test_saturation_deadband_and_rate_limit_shape_the_acting_torque(self):
        torque = np.linspace(-40, 40, 4001)
        got = simulate(with_effect(RIGID, "torque_saturation", limit_nm=25.0), torque, DT)
        assert np.max(np.abs(got["motor_torque_nm"])) == 25.0
        got = simulate(with_effect(RIGID, "torque_deadband", half_width_nm=5.0), torque, DT)
        expected = np.sign(torque) * np.maximum(0, np.abs(torque) - 5)
        np.testing.assert_allclose(got["motor_torque_nm"][1:], expected[:-1], atol=1e-12)
        got = simulate(with_effect(RIGID, "torque_rate_limit", limit_nm_s=100.0), step(at=1), DT)
        assert np.max(np.diff(got["motor_torque_nm"])) == pytest.approx(0.1)
        assert got["motor_torque_nm"][-1] == 20.0

    def test_backlash_passes_no_torque_inside_the_gap(self):
        quiet = np.full(500, 0.01)
        got = simulate(with_effect(THREE, "backlash", half_gap_rad=0.05), quiet, DT)
        assert np.all(got["shaft_torque_nm"] == 0.0)
        np.testing.assert_allclose(
            got["motor_speed_rad_s"], 0.01 / P["motor_inertia"] * np.arange(500) * DT, rtol=1e-9
        )

    def test_backlash_never_pulls(self):
        torque = 20 * np.sin(2 * np.pi * 2 * np.arange(3000) * DT)
        got = simulate(with_effect(THREE, "backlash", half_gap_rad=0.02), torque, DT)
        assert np.mean(got["shaft_torque_nm"] == 0.0) > 0.02

    def test_cubic_stiffness_raises_the_steady_torque_per_twist(self):
        soft = simulate(THREE, step(6000), DT)
        hard = simulate(with_effect(THREE, "shaft_cubic_stiffness", coefficient_nm_rad3=3e6), step(6000), DT)
        assert hard["shaft_torque_nm"][-1] == pytest.approx(soft["shaft_torque_nm"][-1], rel=1e-8)

        def twist(got):
            return np.sum(got["motor_speed_rad_s"] / P["gear_ratio"] - got["wheel_speed_rad_s"]) * DT

        torque = hard["shaft_torque_nm"][-1]
        root = np.roots([3e6, 0, P["shaft_stiffness"], -torque])
        expected = float(root[np.isreal(root)].real[0])
        assert twist(hard) == pytest.approx(expected, rel=1e-3)

    def test_hysteresis_dissipates_energy_in_proportion_to_its_loop(self):
        free = THREE.with_parameters(shaft_damping=0.0)
        torque = step(4000, height=20.0)
        plain = simulate(free, torque, DT)["shaft_torque_nm"]
        looped = simulate(
            with_effect(free, "shaft_hysteresis", stiffness_nm_rad=2000.0, slip_rad=0.005), torque, DT
        )
        assert np.std(looped["shaft_torque_nm"][1500:2500]) < 0.8 * np.std(plain[1500:2500])

    def test_friction_and_drag_take_what_they_say(self):
        got = simulate(with_effect(RIGID, "coulomb_friction", torque_nm=3.0, stribeck_torque_nm=0.0,
                                   offset_nm=1.0), np.full(2000, 20.0), DT)  # fmt: skip
        acceleration = np.diff(got["motor_speed_rad_s"])[1000] / DT
        speed = got["motor_speed_rad_s"][1000]
        assert acceleration == pytest.approx((20.0 - 4.0 - 0.05 * speed) / (0.02 + 300 / 64), rel=1e-5)

    def test_friction_holds_at_standstill(self):
        got = simulate(
            with_effect(THREE, "coulomb_friction", torque_nm=3.0, stribeck_torque_nm=0.0, offset_nm=0.0),
            np.full(1000, 2.0),
            DT,
        )
        assert np.max(np.abs(got["motor_speed_rad_s"])) < 0.25

    def test_mount_agrees_with_lagranges_equations(self):
        jh, kh, dh = 2.0, 2.0 * (2 * np.pi * 18) ** 2, 5.0
        model = with_effect(
            THREE.with_parameters(torque_delay=0.0),
            "mount_mode",
            housing_inertia_kg_m2=jh,
            mount_stiffness_nm_rad=kh,
            mount_damping_nms_rad=dh,
        )
        # Coordinates: rotor against housing, housing, wheel, vehicle. The gear turns with the housing.
        n, j, jw, jv = (P[k] for k in ("gear_ratio", "motor_inertia", "wheel_inertia", "vehicle_inertia"))
        mass = np.array([[j, j, 0, 0], [j, j + jh, 0, 0], [0, 0, jw, 0], [0, 0, 0, jv]])
        shaft = np.array([1 / n, 1.0, -1.0, 0.0])  # twist of the shafts
        tyre = np.array([0.0, 0.0, 1.0, -1.0])
        bush = np.array([0.0, 1.0, 0.0, 0.0])
        stiffness = P["shaft_stiffness"] * np.outer(shaft, shaft)
        stiffness += P["tyre_stiffness"] * np.outer(tyre, tyre) + kh * np.outer(bush, bush)
        damping = P["shaft_damping"] * np.outer(shaft, shaft)
        damping += P["tyre_damping"] * np.outer(tyre, tyre) + dh * np.outer(bush, bush)
        inverse = np.linalg.inv(mass)
        a = np.block([[np.zeros((4, 4)), np.eye(4)], [-inverse @ stiffness, -inverse @ damping]])
        b = np.concatenate([np.zeros(4), inverse @ [1.0, 0, 0, 0]])[:, None]
        c = np.zeros((2, 8))
        c[0, 4] = c[1, 6] = 1.0
        system = control.c2d(control.ss(a, b, c, np.zeros((2, 1))), DT, "zoh")
        _, expected = control.forced_response(system, np.arange(3000) * DT, step())
        got = simulate(model, step(), DT)
        for row, name in enumerate(("motor_speed_rad_s", "wheel_speed_rad_s")):
            np.testing.assert_allclose(got[name], expected[row], atol=1e-9 * np.max(expected[row]))

    def test_a_stiff_mount_is_no_mount(self):
        values = {
            "housing_inertia_kg_m2": 2.0,
            "mount_stiffness_nm_rad": 5e8,
            "mount_damping_nms_rad": 2e4,
        }
        plain = simulate(THREE, step(), DT)["motor_speed_rad_s"]
        mounted = simulate(with_effect(THREE, "mount_mode", **values), step(), DT)["motor_speed_rad_s"]
        np.testing.assert_allclose(mounted, plain, atol=5e-5 * np.max(plain))

    def test_tyre_compliance_makes_three_inertias_of_two(self):
        two = Model(
            "two_inertia",
            {n: P[n] for n in ("motor_inertia", "gear_ratio", "shaft_stiffness", "shaft_damping")}
            | {"vehicle_inertia": P["vehicle_inertia"] + P["wheel_inertia"], "torque_delay": 0.008},
        )
        names = ("wheel_inertia", "tyre_stiffness", "tyre_damping")
        split = with_effect(two, "tyre_compliance", **{n: P[n] for n in names})
        for name, values in simulate(THREE, step(), DT).items():
            np.testing.assert_allclose(simulate(split, step(), DT)[name], values, rtol=1e-9, atol=1e-12)

    def test_wheel_order_follows_the_wheel_angle(self):
        model = with_effect(
            THREE, "wheel_order_disturbance", order=3.0, amplitude_nm=30.0, phase_rad=0.0
        ).with_parameters(vehicle_inertia=1e6)
        got = simulate(model, np.zeros(8192), DT, Start(20 * P["gear_ratio"], 20.0))["shaft_torque_nm"]
        spectrum = np.abs(np.fft.rfft(got * np.hanning(8192)))
        peak_hz = np.fft.rfftfreq(8192, DT)[np.argmax(spectrum[5:]) + 5]
        assert peak_hz == pytest.approx(3 * 20 / (2 * np.pi), abs=0.2)

    def test_motor_order_follows_the_rotor_angle(self):
        model = with_effect(THREE, "motor_order_ripple", order=1.0, amplitude_nm=1.0, phase_rad=0.0)
        got = simulate(model, np.zeros(8192), DT, Start(20 * P["gear_ratio"], 20.0))["motor_speed_rad_s"]
        spectrum = np.abs(np.fft.rfft((got - got.mean()) * np.hanning(8192)))
        peak_hz = np.fft.rfftfreq(8192, DT)[np.argmax(spectrum[5:]) + 5]
        assert peak_hz == pytest.approx(20 * P["gear_ratio"] / (2 * np.pi), abs=0.3)

    def test_running_resistance_slows_the_coast_down(self):
        model = with_effect(RIGID.with_parameters(viscous_drag=0.0), "running_resistance",
                            rolling_nm=30.0, aero_nms2_rad2=0.1)  # fmt: skip
        got = simulate(model, np.zeros(1001), DT, Start(160.0, 20.0))["wheel_speed_rad_s"]
        inertia = 300.0 + 0.02 * 64
        assert (got[1] - got[0]) / DT == pytest.approx(-(30.0 + 0.1 * 400) / inertia, rel=2e-5)

    def test_sensor_effects_change_the_reading_only(self):
        plain = simulate(THREE, step(), DT)
        use = {"channel": "wheel_speed_rad_s"}
        read = simulate(THREE.with_effects(EffectUse("sensor_gain", {**use, "gain": 1.1})), step(), DT)
        np.testing.assert_allclose(read["wheel_speed_rad_s"], 1.1 * plain["wheel_speed_rad_s"])
        np.testing.assert_array_equal(read["motor_speed_rad_s"], plain["motor_speed_rad_s"])
        read = simulate(THREE.with_effects(EffectUse("channel_skew", {**use, "delay_s": 0.01})), step(), DT)
        np.testing.assert_allclose(read["wheel_speed_rad_s"][10:], plain["wheel_speed_rad_s"][:-10])
        read = simulate(
            THREE.with_effects(EffectUse("sensor_quantization", {**use, "step": 0.01})), step(), DT
        )
        np.testing.assert_allclose(
            np.round(read["wheel_speed_rad_s"] / 0.01) * 0.01, read["wheel_speed_rad_s"]
        )


def recording(time, torque, **outputs):
    return Recording({"time_s": time, "motor_torque_ref_nm": torque, **outputs}, Path("memory"))


def test_replay_gives_back_a_recording_of_the_same_model():
    torque = step()
    truth = simulate(THREE, torque, DT, Start(100.0, 100.0 / P["gear_ratio"]))
    got = replay(THREE, recording(10.0 + np.arange(3000) * DT, torque, **truth))
    for name in ("motor_speed_rad_s", "wheel_speed_rad_s", "shaft_torque_nm"):
        np.testing.assert_allclose(got[name], truth[name], rtol=1e-12)


@pytest.mark.parametrize(
    "sensor",
    [
        EffectUse("sensor_offset", {"channel": "shaft_torque_nm", "offset": 20.0}),
        EffectUse("sensor_offset", {"channel": "wheel_speed_rad_s", "offset": -2.0}),
        EffectUse("sensor_gain", {"channel": "motor_speed_rad_s", "gain": 0.9}),
    ],
    ids=lambda use: f"{use.id} of {use.values['channel']}",
)
def test_a_replay_begins_at_what_its_sensors_say_is_true(sensor):
    """A sensor that is off shows another start, and a twist that is not there would ring."""
    model = THREE.with_effects(sensor)
    truth = simulate(model, step(), DT, Start(100.0, 100.0 / P["gear_ratio"]))
    rng = np.random.default_rng(1)
    noise = {name: 1e-3 * np.std(values) * rng.normal(size=3000) for name, values in truth.items()}
    noisy = {name: values + noise[name] for name, values in truth.items()}
    got = replay(model, recording(np.arange(3000) * DT, step(), **noisy))
    for name in ("motor_speed_rad_s", "wheel_speed_rad_s", "shaft_torque_nm"):
        assert np.sqrt(np.mean((got[name] - truth[name]) ** 2)) < 1e-3 * np.std(truth[name])


@pytest.mark.parametrize("channel", ["motor_speed_rad_s", "wheel_speed_rad_s"])
@pytest.mark.parametrize("model", [THREE, load_model(BENCHES / "paper_functions.toml")], ids=lambda m: m.kind)
def test_a_speed_that_was_not_recorded_starts_with_the_other_over_the_gear(model, channel):
    truth = simulate(model, np.zeros(3000), DT, Start(100.0, 100.0 / P["gear_ratio"]))
    got = replay(model, recording(np.arange(3000) * DT, np.zeros(3000), **{channel: truth[channel]}))
    for name in ("motor_speed_rad_s", "wheel_speed_rad_s"):
        np.testing.assert_allclose(got[name], truth[name], rtol=1e-3)


def test_a_recording_that_starts_with_its_torque_at_rest_has_no_torque_before():
    torque = np.full(2000, 20.0)
    truth = simulate(THREE, np.concatenate([np.zeros(50), torque]), DT)
    from_rest = {name: values[50:] for name, values in truth.items()}
    got = replay(THREE, recording(np.arange(2000) * DT, torque, **from_rest))
    np.testing.assert_allclose(got["motor_speed_rad_s"], from_rest["motor_speed_rad_s"], atol=1e-9)


def test_a_recording_that_starts_under_steady_torque_goes_on_with_it():
    torque = np.full(8000, 20.0)
    truth = {name: values[5000:] for name, values in simulate(THREE, torque, DT).items()}
    got = replay(THREE, recording(np.arange(3000) * DT, torque[5000:], **truth))
    np.testing.assert_allclose(got["shaft_torque_nm"], truth["shaft_torque_nm"], rtol=0.01)


@pytest.mark.parametrize("play", [False, True])
def test_a_recording_that_begins_in_mid_motion_begins_with_its_vehicle(play):
    """A vehicle that is ahead of its wheels pulls them along for the rest of a recording."""
    model = THREE.with_effects(*([EffectUse("backlash", {"half_gap_rad": 0.01})] if play else []))
    torque = 20.0 * np.sin(2 * np.pi * 1.3 * np.arange(9000) * DT)
    truth = simulate(model, torque, DT, Start(100.0, 100.0 / P["gear_ratio"]))
    late = {name: values[3100:] for name, values in truth.items()}
    got = replay(model, recording(np.arange(5900) * DT, torque[3100:], **late))
    speed = late["wheel_speed_rad_s"]
    assert np.sqrt(np.mean((got["wheel_speed_rad_s"] - speed) ** 2)) < 0.05 * np.std(speed)


def test_uneven_time_stamps_are_resampled_and_said():
    torque = step()
    truth = simulate(THREE, torque, DT)
    keep = np.ones(3000, bool)
    keep[500:520] = False
    time = np.arange(3000) * DT
    got = replay(
        THREE, recording(time[keep], torque[keep], motor_speed_rad_s=truth["motor_speed_rad_s"][keep])
    )
    assert any("uneven" in note for note in got.notes)
    np.testing.assert_allclose(
        got["motor_speed_rad_s"], truth["motor_speed_rad_s"][keep], rtol=1e-9, atol=1e-9
    )


def test_a_wrong_drag_of_a_rigid_model_is_the_drag_itself():
    parameters = {"motor_inertia": 0.02, "gear_ratio": 8.0, "vehicle_inertia": 300.0, "torque_delay": 0.006}
    wrong = Model("rigid", {**parameters, "viscous_drag": 0.001}).with_effects(
        EffectUse("parameter_mismatch", {"parameter": "viscous_drag", "value": 0.003})
    )
    right = Model("rigid", {**parameters, "viscous_drag": 0.003})
    assert np.array_equal(pack(wrong), pack(right))


@pytest.mark.parametrize(
    "model",
    [
        THREE.with_parameters(shaft_damping=1e5),
        THREE.with_effects(
            EffectUse("backlash", {"half_gap_rad": 0.02, "contact_damping_nms_rad": 1e5, "restitution": 1.0})
        ),
    ],
)
def test_a_simulation_that_diverges_is_refused(model):
    time = np.arange(3000, dtype=np.float64) * DT
    torque = 30.0 * np.sin(20.0 * time)
    recording = Recording({"time_s": time, "motor_torque_ref_nm": torque}, Path("x.csv"))
    with pytest.raises(BadInputError, match=r"diverges.*( from 0\.\d+ s on|too fast for the integrator)"):
        replay(model, recording)
