"""One sensor law for replay, for many models and for the bench."""

import numpy as np
import pytest

from hil.core.errors import BadInputError
from hil.core.model import EffectUse, Model
from hil.plant import bench_sensor, ideal_sensors, pack, simulate, simulate_many
from hil.plant.closed_loop.tick import PAST, _sense
from hil.plant.sensors import COLUMNS, DELAY, GAIN, LAG, record, sensor_of
from sim_backend.bench import SimulatedBench, SimulationSettings
from tests.benches_for_tests import SIM

DT = 1e-3
CHANNEL = "motor_speed_rad_s"
RIGID = Model(
    "rigid",
    {
        "motor_inertia": 0.02,
        "gear_ratio": 8.148,
        "vehicle_inertia": 303.0,
        "viscous_drag": 0.02,
        "torque_delay": 0.0035,
    },
)


def sensed(delay_s: float, *more: EffectUse) -> Model:
    values = {"channel": CHANNEL}
    return RIGID.with_effects(
        EffectUse("channel_skew", {**values, "delay_s": delay_s}),
        EffectUse("sensor_gain", {**values, "gain": 1.02}),
        EffectUse("sensor_offset", {**values, "offset": 0.3}),
        *more,
    )


def on_the_bench(truth: np.ndarray, sensor: np.ndarray) -> np.ndarray:
    past = np.zeros(PAST)
    return np.array([_sense(value, 0.0, sensor, past, k, DT) for k, value in enumerate(truth)])


@pytest.mark.parametrize("lag_s", [0.0, 0.0007, 0.02])
@pytest.mark.parametrize("delay_s", [0.0, 0.0004, 0.002, 0.0137])
def test_replay_many_models_and_bench_read_the_same(delay_s, lag_s):
    model = sensed(
        delay_s,
        EffectUse("sensor_quantization", {"channel": CHANNEL, "step": 0.25}),
        EffectUse("sensor_lag", {"channel": CHANNEL, "time_constant_s": lag_s}),
    )
    torque = 40.0 * np.sin(0.02 * np.arange(400))
    torque[0] = 0.0
    truth = simulate(RIGID, torque, DT)[CHANNEL]
    replayed = simulate(model, torque, DT)[CHANNEL]
    np.testing.assert_array_equal(on_the_bench(truth, bench_sensor(model, CHANNEL)), replayed)
    sensors = ideal_sensors(1)
    sensors[0, 0] = sensor_of(model, CHANNEL)
    many = simulate_many(pack(model)[None], torque, DT, np.zeros((1, 3)), sensors)[0, :, 0]
    # the truths of both kernels differ by their step, which may move a reading by one step of the sensor
    assert np.mean(np.abs(many - replayed) > 1e-9) < 0.02
    np.testing.assert_allclose(many, replayed, atol=0.25 + 1e-9)


def test_an_early_channel_shows_now_what_the_others_show_later():
    torque = 40.0 * np.sin(0.02 * np.arange(400))
    torque[0] = 0.0
    truth = simulate(RIGID, torque, DT)[CHANNEL]
    early = EffectUse("channel_skew", {"channel": CHANNEL, "delay_s": -0.005})
    found = simulate(RIGID.with_effects(early), torque, DT)[CHANNEL]
    np.testing.assert_array_equal(found[:-5], truth[5:])
    np.testing.assert_array_equal(found[-5:], truth[-1])


def test_a_bench_refuses_an_early_channel_when_it_opens():
    early = RIGID.with_effects(EffectUse("channel_skew", {"channel": CHANNEL, "delay_s": -0.005}))
    with pytest.raises(BadInputError, match=r"motor_speed_rad_s.* 5 ms early"):
        SimulatedBench(SimulationSettings(early, SIM.rmcu.dbc, SIM.dyno.eds))


@pytest.mark.parametrize("lag_s", [1e-5, 0.0005, 0.004, 0.5])
def test_a_low_pass_follows_a_ramp_late_by_its_time_constant(lag_s):
    time_s = np.arange(3000) * DT
    sensor = np.zeros(COLUMNS)
    sensor[GAIN], sensor[LAG] = 1.0, lag_s
    found = np.empty(len(time_s))
    record(3.0 * time_s, sensor, DT, 1, found)
    ramp = 3.0 * (time_s - lag_s * (1.0 - np.exp(-time_s / lag_s)))
    np.testing.assert_allclose(found, ramp, atol=1e-12)


def test_a_low_pass_has_the_gain_and_phase_of_its_formula():
    time_s, omega, lag_s = np.arange(20_000) * 1e-4, 2.0 * np.pi * 15.0, 0.01
    sensor = np.zeros(COLUMNS)
    sensor[GAIN], sensor[LAG] = 1.0, lag_s
    found = np.empty(len(time_s))
    record(np.sin(omega * time_s), sensor, 1e-4, 1, found)
    wanted = np.imag(np.exp(1j * omega * time_s) / (1.0 + 1j * omega * lag_s))
    np.testing.assert_allclose(found[5000:], wanted[5000:], atol=1e-5)


@pytest.mark.parametrize(
    ("effect", "size"), [("sensor_quantization", "step"), ("sensor_lag", "time_constant_s")]
)
def test_a_channel_is_rounded_and_low_passed_once(effect, size):
    use = EffectUse(effect, {"channel": CHANNEL, size: 0.25})
    with pytest.raises(BadInputError, match="stands twice for 'motor_speed_rad_s'"):
        simulate(RIGID.with_effects(use, use), np.zeros(10), DT)


def test_each_side_of_the_bench_reads_its_share():
    model = RIGID.with_effects(
        EffectUse("sensor_offset", {"channel": "shaft_torque_nm", "offset": 3.0}),
        EffectUse("sensor_quantization", {"channel": "shaft_torque_nm", "step": 2.0}),
        EffectUse("sensor_gain", {"channel": "shaft_torque_nm", "gain": 1.1}),
    )
    whole, side = bench_sensor(model, "shaft_torque_nm"), bench_sensor(model, "shaft_torque_nm", 0.5)
    truth = np.linspace(-90.0, 90.0, 41)
    np.testing.assert_allclose(2.0 * on_the_bench(0.5 * truth, side), on_the_bench(truth, whole))


@pytest.mark.parametrize("late", [0.5, -0.3, 2.25])
def test_a_swing_that_is_late_by_part_of_a_sample_keeps_its_height(late):
    """Straight lines between samples would cut its crests by part·(1-part)/2 of (omega dt)²: 0.4 %."""
    dt, omega = 1e-3, 2.0 * np.pi * 30.0
    time_s = np.arange(2000) * dt
    sensor = np.zeros(COLUMNS)
    sensor[GAIN], sensor[DELAY] = 1.0, late * dt
    out = np.empty(len(time_s))
    record(np.sin(omega * time_s), sensor, dt, 1, out)
    np.testing.assert_allclose(out[10:-10], np.sin(omega * (time_s - late * dt))[10:-10], atol=1e-4)


def test_a_low_pass_of_a_swing_keeps_its_height():
    """With samples of half its time constant; straight lines would cut (omega dt)²/12: 0.3 %."""
    dt, omega, lag_s = 1e-3, 2.0 * np.pi * 30.0, 2e-3
    time_s = np.arange(2000) * dt
    sensor = np.zeros(COLUMNS)
    sensor[GAIN], sensor[LAG] = 1.0, lag_s
    out = np.empty(len(time_s))
    record(np.sin(omega * time_s), sensor, dt, 1, out)
    wanted = np.imag(np.exp(1j * omega * time_s) / (1.0 + 1j * omega * lag_s))
    np.testing.assert_allclose(out[100:-10], wanted[100:-10], atol=1e-4)
