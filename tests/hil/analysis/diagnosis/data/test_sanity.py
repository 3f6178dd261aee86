"""What no physics can explain is refused by name; noise is read once and handed on."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from hil.analysis.diagnosis.data.sanity import examine
from hil.core.channels import INPUT, OUTPUTS, TIME
from hil.core.errors import BadInputError
from hil.core.model import EffectUse, Model
from hil.core.recording import Recording
from hil.plant import simulate
from tests.hil.analysis.diagnosis.one_recording import MODEL, NOISE, recorded


def test_good_recordings_come_without_a_note() -> None:
    series, notes = examine(MODEL, [recorded()])
    assert [one.source for one in series] == ["one.csv"]
    assert notes == []


def test_nothing_is_examined_where_nothing_is_given() -> None:
    assert examine(MODEL, []) == ([], [])


def test_recordings_held_out_that_show_no_motion_are_to_be_left_out() -> None:
    one = recorded(seconds=8.0)
    fitted, _ = examine(MODEL, [one])
    still = {name: one[name] if name == TIME else np.zeros_like(one[name]) for name in one.channels}
    with pytest.raises(BadInputError, match="nothing to check a model by") as refused:
        examine(MODEL, [dataclasses.replace(one, channels=still)], fitted)
    assert "leave them out" in str(refused.value.fix)


def test_an_inverted_channel_is_named() -> None:
    one = recorded(seconds=8.0)
    turned = dataclasses.replace(one, channels={**one.channels, "shaft_torque_nm": -one["shaft_torque_nm"]})
    with pytest.raises(BadInputError, match="shaft_torque_nm looks inverted"):
        examine(MODEL, [turned])


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_a_speed_that_drifts_slowly_is_not_inverted(sign: float) -> None:
    one = recorded(seconds=16.0)
    time = one["time_s"]
    torque = 20.0 * np.sin(2 * np.pi * (0.2 * time + 0.1 * time**2))  # slow: both speeds go together
    clean = simulate(MODEL, torque, 1e-3)
    rng = np.random.default_rng(7)
    channels = {
        name: values + 1e-3 * np.std(values) * rng.normal(size=len(time)) for name, values in clean.items()
    }
    speed = channels["wheel_speed_rad_s"]
    channels["wheel_speed_rad_s"] = speed + sign * 0.4 * np.std(speed) * np.sin(2 * np.pi * time / 25.0)
    told = {**one.channels, **channels, "motor_torque_ref_nm": torque}
    examine(MODEL, [dataclasses.replace(one, channels=told)])


@pytest.mark.parametrize("channel", ["motor_speed_rad_s", "wheel_speed_rad_s"])
@pytest.mark.parametrize("phase", [0.0, 1.6])
def test_a_drift_as_large_as_the_motion_is_no_wrong_speed(channel: str, phase: float) -> None:
    one = recorded(seconds=40.0)
    time = one["time_s"]
    torque = 10.0 * np.cos(2 * np.pi * 0.4 / 0.16 * np.expm1(0.16 / 8.0 * time))  # 0.05 to 0.11 Hz
    torque += 5.0 * np.sin(2 * np.pi * 0.7 * time)
    clean = simulate(MODEL, torque, 1e-3)
    rng = np.random.default_rng(7)
    channels = {
        name: values + 1e-3 * np.std(values) * rng.normal(size=len(time)) for name, values in clean.items()
    }
    swing = np.sin(2 * np.pi * time / 50.0 + phase)
    channels[channel] = channels[channel] + 3.0 * np.std(channels[channel]) * (swing - swing[0])
    told = {**one.channels, **channels, "motor_torque_ref_nm": torque}
    examine(MODEL, [dataclasses.replace(one, channels=told)])


@pytest.mark.parametrize("factor", [-1.0, 0.4, 9.55])
def test_a_wrong_speed_is_refused_though_it_drifts(factor: float) -> None:
    one = recorded(seconds=30.0)
    time = one["time_s"]
    torque = 60.0 * np.sin(2 * np.pi * (0.1 * time + 0.01 * time**2))
    clean = simulate(MODEL, torque, 1e-3)
    wheel = clean["wheel_speed_rad_s"] + 0.3 * np.std(clean["wheel_speed_rad_s"]) * np.sin(time / 8.0)
    told = {**one.channels, **clean, "wheel_speed_rad_s": factor * wheel, "motor_torque_ref_nm": torque}
    with pytest.raises(BadInputError, match="inverted|gear ratio looks wrong|looks like rpm"):
        examine(MODEL, [dataclasses.replace(one, channels=told)])


def test_a_speed_that_rests_beside_a_drifting_one_is_not_dead() -> None:
    one = recorded(seconds=8.0)
    time = one["time_s"]
    rng = np.random.default_rng(5)
    torque = 0.5 * np.sin(2 * np.pi * 3.0 * time)
    told = {**one.channels, **simulate(MODEL, torque, 1e-3), "motor_torque_ref_nm": torque}
    told["wheel_speed_rad_s"] = told["wheel_speed_rad_s"] + rng.normal(0.0, 0.05, len(time))
    told["motor_speed_rad_s"] = told["motor_speed_rad_s"] + 16.0 * np.sin(2 * np.pi * time / 50.0)
    examine(MODEL, [dataclasses.replace(one, channels=told)])


@pytest.mark.parametrize("first", [True, False])
def test_a_recording_in_rpm_is_named_beside_a_good_one(first: bool) -> None:
    good, one = recorded(seconds=8.0), recorded(seconds=8.0, seed=2)
    wheels = {name: one[name] * 60.0 / (2.0 * np.pi) for name in ("motor_speed_rad_s", "wheel_speed_rad_s")}
    wrong = dataclasses.replace(one, channels={**one.channels, **wheels}, source=Path("rpm.csv"))
    with pytest.raises(BadInputError, match="look like rpm") as refused:
        examine(MODEL, [wrong, good] if first else [good, wrong])
    assert refused.value.where == "rpm.csv"


def _limited(unit: float, model: Model = MODEL, limit_nm: float = 25.0) -> Recording:
    """A slow swing around 29 N m, torque that ends at `limit_nm`, the shaft torque in another unit."""
    rng = np.random.default_rng(4)
    time = np.arange(0.0, 12.0, 1e-3)
    torque = np.minimum(20.0 * time, 1.0) * (29.0 + 7.0 * np.sin(2 * np.pi * 0.2 * time))
    shown = simulate(model.with_effects(EffectUse("torque_saturation", {"limit_nm": limit_nm})), torque, 1e-3)
    noisy = {
        name: shown[name] + rng.normal(0.0, level, len(time))
        for name, level in zip(OUTPUTS, NOISE, strict=True)
    }
    noisy["shaft_torque_nm"] = unit * noisy["shaft_torque_nm"]
    return Recording({TIME: time, INPUT: torque, **noisy}, Path("limited.csv"))


def test_a_torque_that_its_limit_holds_is_in_no_other_unit() -> None:
    assert examine(MODEL, [_limited(1.0)])[0]
    with pytest.raises(BadInputError, match="looks like kN m"):
        examine(MODEL, [_limited(1e-3)])


def test_a_rotor_that_takes_most_of_its_torque_itself_leaves_the_shaft_little() -> None:
    """A motor with a small load on its bench: a fifth of the torque passes the shaft."""
    ratio = MODEL.parameters["gear_ratio"]
    light = {"wheel_inertia": 0.1, "vehicle_inertia": 0.2 * MODEL.parameters["motor_inertia"] * ratio**2}
    small = MODEL.with_parameters(**light)
    assert examine(small, [_limited(1.0, small, 1000.0)])[0]
    with pytest.raises(BadInputError, match="looks like kN m"):
        examine(small, [_limited(1e-3, small, 1000.0)])
