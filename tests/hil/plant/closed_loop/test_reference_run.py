"""The same seed gives the same channels as ever: a short run of the simulated bench against kept numbers.

The kept file holds what the bench showed before its physics was brought together in one place. Its numbers
may only change when a law is meant to change: those of `effects` did when memories of effects began to move
within a step (3e-2 rad/s; at steps of 4 microseconds both say the same, and the new way is nearer to it).
They begin at a moment of their own, so that a longer start of the bench draws no other noise.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drivers.measurement import SampleAssembler
from hil.core.model import EffectUse, Model, load_model, save_model
from tests.benches_for_tests import SIM, running

EVERY = 20
BEGIN_S = 2.0
KEPT = Path(__file__).with_name("reference_run.csv")
CHANNELS = {  # and about the resolution of the wire
    "motor_speed_rad_s": 0.001,
    "motor_torque_nm": 0.026,  # half a step of 0.05 N m
    "wheel_speed_left_rad_s": 2e-5,
    "wheel_speed_right_rad_s": 2e-5,
    "shaft_torque_left_nm": 0.002,
    "shaft_torque_right_nm": 0.002,
}
EFFECTS = (
    EffectUse("backlash", {"half_gap_rad": 0.02}),
    EffectUse("shaft_cubic_stiffness", {"coefficient_nm_rad3": 2e5}),
    EffectUse("shaft_hysteresis", {"stiffness_nm_rad": 900.0, "slip_rad": 0.01}),
    EffectUse("coulomb_friction", {"torque_nm": 1.5, "stribeck_torque_nm": 0.8, "offset_nm": 0.3}),
    EffectUse("viscous_drag", {"coefficient_nms_rad": 0.01}),
    EffectUse(
        "mount_mode",
        {"housing_inertia_kg_m2": 2.0, "mount_stiffness_nm_rad": 2e4, "mount_damping_nms_rad": 30.0},
    ),
    EffectUse("actuator_lag", {"time_constant_s": 0.004}),
    EffectUse("torque_deadband", {"half_width_nm": 0.5}),
    EffectUse("torque_saturation", {"limit_nm": 35.0}),
    EffectUse("torque_rate_limit", {"limit_nm_s": 3000.0}),
    EffectUse("wheel_order_disturbance", {"order": 3.0, "amplitude_nm": 8.0, "phase_rad": 0.4}),
    EffectUse("motor_order_ripple", {"order": 6.0, "amplitude_nm": 0.5, "phase_rad": 0.2}),
    EffectUse("running_resistance", {"rolling_nm": 40.0, "aero_nms2_rad2": 0.1}),
    EffectUse("sensor_gain", {"channel": "motor_speed_rad_s", "gain": 1.02}),
    EffectUse("sensor_offset", {"channel": "shaft_torque_nm", "offset": 3.0}),
    EffectUse("channel_skew", {"channel": "wheel_speed_rad_s", "delay_s": 0.0034}),
    EffectUse("sensor_quantization", {"channel": "shaft_torque_nm", "step": 2.0}),
)
RIGID = Model(
    "rigid",
    {
        "motor_inertia": 0.02,
        "gear_ratio": 8.148,
        "vehicle_inertia": 303.0,
        "viscous_drag": 0.02,
        "torque_delay": 0.0035,
    },
    (EffectUse("coulomb_friction", {"torque_nm": 2.0}),),
)


def short_run(model: Model, directory: Path) -> np.ndarray:
    """0.8 s of torque that reverses: every 20th sample of the decoded channels."""
    save_model(model, directory / "model.toml")
    simulation = SIM.simulation.model_copy(update={"model": directory / "model.toml"})
    with running("reference", simulation=simulation) as bench:
        bench.loop.run_for(BEGIN_S - bench.loop.clock.now_s())
        assembler = SampleAssembler(bench.streams, 1e-3)
        for source in bench.sources:
            list(source.samples())  # what came before counts for nothing
        bench.dyno.enable(10.0)
        bench.dyno.release_vehicle(0.0)
        for payload in bench.rmcu.requests("motor_torque", 40.0 * np.sin(np.arange(800) * 0.02)):
            bench.rmcu.send(payload)
            bench.loop.step()
        bench.loop.drain()
        for source in bench.sources:
            for samples in source.samples():
                assembler.add(samples)
        rows = assembler.rows(everything=True)
        columns = [assembler.names.index(name) for name in CHANNELS]
    return rows[-800::EVERY, columns]


def models() -> dict[str, Model]:
    shipped = load_model(SIM.simulation.model)
    return {
        "three": shipped,
        "effects": Model(shipped.kind, shipped.parameters, EFFECTS),
        "rigid": RIGID,
    }


@pytest.mark.parametrize("name", ["three", "effects", "rigid"])
def test_the_same_seed_gives_the_same_channels_as_ever(name, tmp_path):
    kept = np.loadtxt(KEPT, delimiter=",", skiprows=1)
    part = kept.reshape(3, -1, len(CHANNELS))[list(models()).index(name)]
    found = short_run(models()[name], tmp_path)
    for column, (channel, within) in enumerate(CHANNELS.items()):
        np.testing.assert_allclose(found[:, column], part[:, column], rtol=0, atol=within, err_msg=channel)
