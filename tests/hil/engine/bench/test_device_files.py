"""Benches whose DBC lays the signals out in other ways: the channels are the same."""

import re
from pathlib import Path

import numpy as np
import pytest

from drivers import Binding, FrameSource
from hil.core.can.frames import FRAME
from hil.core.can.signals import Signal
from hil.core.errors import BenchError
from hil.core.recording import read_recording
from hil.engine import RunRequest, run_plan
from hil.engine.run.limits import LimitWatch
from tests.benches_for_tests import SIM, plan, sim_bench

STEPS = """
  - set_controller: {file: phase_stabilization.toml}
  - hold_speed: {speed_km_h: 5, duration_s: 0.2}
  - step: {segment: s, quantity: driving_torque, from_nm: 0, to_nm: 100, before_s: 0.2, after_s: 0.5}
"""
DBC = SIM.rmcu.dbc.read_text()


def big_endian(dbc: str) -> str:
    """The same signals as Motorola signals, each in the bits that its Intel twin has."""

    def turned(match):
        first = int(match[1])
        return f": {8 * (first // 8) + 7 - first % 8}|{match[2]}@0"

    return re.sub(r": (\d+)\|(\d+)@1", turned, dbc)


def with_floats(dbc: str) -> str:
    """The motor speed as a float, the torques in what room is left; neither counter nor checksum."""
    for old, new in (
        ("MotorSpeed : 4|22@1- (0.001,0)", "MotorSpeed : 0|32@1- (1,0)"),
        ("MotorTorqueRef : 26|16@1- (0.01,0)", "MotorTorqueRef : 32|16@1- (0.01,0)"),
        ("MotorTorque : 42|14@1- (0.05,0)", "MotorTorque : 48|16@1- (0.01,0)"),
        (' SG_ Counter : 0|4@1+ (1,0) [0|15] "" HOST\n SG_ MotorSpeed', " SG_ MotorSpeed"),
        (' SG_ Crc : 56|8@1+ (1,0) [0|255] "" HOST\n\nBO_ 273', "\nBO_ 273"),
        ('CM_ SG_ 272 Counter "Number of the sample, modulo 16.";\n', ""),
        ('CM_ SG_ 272 Crc "CRC-8 SAE J1850 over the low byte of the identifier and bytes 0 to 6.";\n', ""),
    ):
        assert old in dbc
        dbc = dbc.replace(old, new)
    return dbc + "SIG_VALTYPE_ 272 MotorSpeed : 1;\n"


def channels(directory: Path, dbc: str) -> dict[str, np.ndarray]:
    directory.mkdir()
    path = directory / "other.dbc"
    path.write_text(dbc)
    bench = sim_bench(directory.name, rmcu=SIM.rmcu.model_copy(update={"dbc": path}))
    outcome = run_plan(RunRequest(plan(STEPS), bench, directory / "out"))
    assert outcome.error is None
    return dict(read_recording(outcome.recording).channels)


def test_a_big_endian_dbc_gives_the_same_channels(tmp_path):
    there = channels(tmp_path / "intel", DBC)
    turned = big_endian(DBC)
    assert "@1" not in turned
    found = channels(tmp_path / "motorola", turned)
    assert np.max(there["shaft_torque_nm"]) > 50
    for name, values in there.items():
        np.testing.assert_array_equal(found[name], values, err_msg=name)


@pytest.mark.parametrize("turn", [str, big_endian], ids=["little-endian", "big-endian"])
def test_a_speed_as_a_float_gives_the_same_channels(turn, tmp_path):
    there = channels(tmp_path / "integers", DBC)
    found = channels(tmp_path / "floats", turn(with_floats(DBC)))
    # The firmware acts on the speed itself, not on its frame: only the frame's rounding differs.
    np.testing.assert_allclose(found["motor_speed_rad_s"], there["motor_speed_rad_s"], atol=0.0006)
    np.testing.assert_allclose(found["motor_torque_ref_nm"], there["motor_torque_ref_nm"], atol=0.006)


def test_frames_without_checksum_or_counter_are_named_in_the_result(tmp_path):
    path = tmp_path / "bare.dbc"
    path.write_text(with_floats(DBC))
    bench = sim_bench("bare", rmcu=SIM.rmcu.model_copy(update={"dbc": path}))
    outcome = run_plan(RunRequest(plan(STEPS), bench, tmp_path / "out"))
    said = {one.name: one.value for one in outcome.result.identities if one.device == "rmcu"}
    assert said["frames without checksum"] == "RMCU_Status"
    assert said["frames without counter"] == "RMCU_Status"
    checked = run_plan(RunRequest(plan(STEPS), sim_bench("checked"), tmp_path / "checked"))
    assert not any("without" in one.name for one in checked.result.identities)


@pytest.mark.parametrize("big", [False, True])
@pytest.mark.parametrize(("length", "is_float"), [(16, False), (32, True), (64, True)])
def test_limits_read_a_signal_as_it_is_laid_out(length, is_float, big):
    signal = Signal("s", 0, length, signed=True, is_float=is_float, big_endian=big, unit="rad/s")
    source = FrameSource([Binding("b", 0x110, signal, "motor_speed_rad_s")], 0.001)
    watch = LimitWatch(source.streams, SIM.limits)
    block = np.zeros(3, FRAME)
    block["time_s"], block["id"] = [0.001, 0.002, 0.003], 0x110
    block["length"] = 8
    block["data"] = signal.encode([-300.0, 20.0, 250.0])
    source.take("b", block)
    (samples,) = source.samples()
    watch.take(samples, 0.0)
    assert watch.largest == {"motor_speed_rad_s": 300.0}


def test_a_speed_that_is_not_a_number_trips_its_limit():
    signal = Signal("s", 0, 32, is_float=True, unit="rad/s")
    source = FrameSource([Binding("b", 0x110, signal, "motor_speed_rad_s")], 0.001)
    watch = LimitWatch(source.streams, SIM.limits)
    watch.active = True
    block = np.zeros(20, FRAME)
    block["time_s"], block["id"] = np.arange(20) * 0.001, 0x110
    block["length"] = 8
    block["data"] = signal.encode(np.full(20, np.nan))
    source.take("b", block)
    (samples,) = source.samples()
    with pytest.raises(BenchError, match="limit tripped"):
        watch.take(samples, 0.0)
