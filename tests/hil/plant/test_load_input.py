"""A recorded torque at the wheels as a second input: both integrators, and an axle without its vehicle."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from hil.analysis.control_design import design_plant
from hil.core.channels import INPUT, OUTPUTS, TIME
from hil.core.errors import BadInputError
from hil.core.model import EffectUse, Model, load_model, model_from_dict, save_model
from hil.core.recording import Recording
from hil.plant import Start, ideal_sensors, load_of, pack, replay, simulate, simulate_many
from tests.hil.analysis.diagnosis.reference_plant import BASE

LOAD = "dyno_torque_ref_nm"
DT = 1e-3
TIME_S: npt.NDArray[np.float64] = np.arange(3000.0) * DT
TORQUE = np.where(TIME_S > 0.5, 15.0, 0.0)
BRAKES = 60.0 * np.sin(2 * np.pi * 4.0 * TIME_S**2)
AXLE = {k: BASE[k] for k in ("motor_inertia", "gear_ratio", "shaft_stiffness", "shaft_damping")}
KINDS = {
    "rigid": Model(
        "rigid",
        {k: BASE[k] for k in ("motor_inertia", "gear_ratio", "vehicle_inertia")}
        | {"viscous_drag": 0.01, "torque_delay": 0.0},
    ),
    "two_inertia": Model("two_inertia", AXLE | {"vehicle_inertia": 5.0, "torque_delay": 0.0}),
    "three_inertia": Model("three_inertia", dict(BASE) | {"torque_delay": 0.0}),
}


@pytest.mark.parametrize(
    "effects", [(), (EffectUse("running_resistance", {"rolling_nm": 20.0, "aero_nms2_rad2": 0.05}),)]
)
@pytest.mark.parametrize("kind", KINDS)
def test_both_integrators_brake_the_wheels_alike(kind: str, effects: tuple[EffectUse, ...]) -> None:
    model = KINDS[kind].with_effects(*effects)
    start = Start(40.0 * BASE["gear_ratio"], 40.0, 0.0)
    expected = simulate(model, TORQUE, DT, start, load_nm=BRAKES)
    begin = np.array([[start.motor_speed_rad_s, start.wheel_speed_rad_s, 0.0]])
    found = simulate_many(pack(model)[None], TORQUE, DT, begin, ideal_sensors(1), load_nm=BRAKES)[0]
    for column, channel in enumerate(OUTPUTS):
        assert np.ptp(expected[channel] - simulate(model, TORQUE, DT, start)[channel]) > 0.02
        off = np.sqrt(np.mean((found[:, column] - expected[channel]) ** 2))
        assert off < 2e-3 * np.std(expected[channel]), channel


def test_braking_takes_the_momentum_that_it_says() -> None:
    model = KINDS["rigid"].with_parameters(viscous_drag=0.0)
    n = model.parameters["gear_ratio"]
    inertia = model.parameters["motor_inertia"] * n**2 + model.parameters["vehicle_inertia"]
    wheel = simulate(model, np.zeros(3000), DT, Start(40.0 * n, 40.0, 0.0), load_nm=BRAKES)[OUTPUTS[1]]
    impulse = np.concatenate([[0.0], np.cumsum(0.5 * DT * (BRAKES[1:] + BRAKES[:-1]))])
    assert wheel == pytest.approx(40.0 - impulse / inertia, rel=1e-9)


def test_the_axle_alone_explains_what_the_whole_vehicle_does() -> None:
    whole = KINDS["three_inertia"]
    shown = simulate(whole, TORQUE, DT)
    wheel, shaft = shown["wheel_speed_rad_s"], shown["shaft_torque_nm"]
    road = shaft - whole.parameters["wheel_inertia"] * np.gradient(wheel, DT)
    alone = Model(
        "two_inertia",
        AXLE | {"vehicle_inertia": whole.parameters["wheel_inertia"], "torque_delay": 0.0},
        load_input=LOAD,
    )
    recording = Recording(
        {TIME: TIME_S, INPUT: TORQUE, LOAD: road, **{c: shown[c] for c in OUTPUTS}}, Path("bench.csv")
    )
    said = replay(alone, recording)
    for channel in OUTPUTS:
        assert np.std(said[channel] - shown[channel]) < 0.01 * np.std(shown[channel]), channel
    assert np.array_equal(said[LOAD], road)


def test_a_recording_without_the_load_is_told_so() -> None:
    model = dataclasses.replace(KINDS["two_inertia"], load_input=LOAD)
    recording = Recording({TIME: TIME_S, INPUT: TORQUE}, Path("drive.csv"))
    with pytest.raises(BadInputError, match=f"no channel {LOAD}") as told:
        replay(model, recording)
    assert told.value.where == "drive.csv"
    assert load_of(KINDS["two_inertia"], recording) is None


def test_a_model_file_keeps_its_load(tmp_path: Path) -> None:
    model = dataclasses.replace(KINDS["two_inertia"], load_input=LOAD)
    save_model(model, tmp_path / "axle.toml")
    assert load_model(tmp_path / "axle.toml") == model


@pytest.mark.parametrize(
    ("kind", "load", "told"),
    [
        ("two_inertia", "wheel_torque", "load_input is 'wheel_torque'"),
        ("transfer_function", LOAD, "has no load_input"),
    ],
)
def test_a_load_that_makes_no_sense_is_refused(kind: str, load: str, told: str) -> None:
    parameters = (
        {"parameters": KINDS[kind].parameters}
        if kind in KINDS
        else {"transfer_functions": {OUTPUTS[0]: {"numerator": [1.0], "denominator": [1.0, 1.0]}}}
    )
    with pytest.raises(BadInputError, match=told):
        model_from_dict({"kind": kind, "load_input": load, **parameters}, "axle.toml")


def test_without_its_vehicle_nothing_is_designed() -> None:
    with pytest.raises(BadInputError, match="does not hold the vehicle"):
        design_plant(dataclasses.replace(KINDS["two_inertia"], load_input=LOAD))
