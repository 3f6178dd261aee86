"""A bench's devices as decoders."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drivers import read_rmcu
from hil.core.can.frames import FrameBlock, crc8_many, frames, inserted
from hil.core.can.signals import Payloads
from hil.core.errors import BadInputError
from hil.core.recording import read_frames
from hil.engine.replay._bench import BenchDecoder
from tests.benches_for_tests import SIM

LAYOUTS = read_rmcu(SIM.rmcu.dbc).layouts


def status(count: int) -> FrameBlock:
    return frames(
        LAYOUTS["RMCU_Status"].id,
        checked("RMCU_Status", Counter=np.arange(count) % 16),
        8,
        1e-3 * np.arange(float(count)),
    )


def checked(message: str, **values: Any) -> Payloads:
    """Payloads of a message under their checksum."""
    layout = LAYOUTS[message]
    payloads = layout.encode(**values)
    return payloads | layout.signals["Crc"].encode(crc8_many(layout.id, payloads))


def test_only_devices_of_the_buses_that_are_there_give_channels(tmp_path: Path) -> None:
    count = 300
    control = LAYOUTS["RMCU_Control"]
    payloads = checked("RMCU_Control", Counter=np.arange(count) % 256, DrivingTorqueRef=np.full(count, 5.0))
    counted = frames(control.id, payloads, 8, 1e-3 * np.arange(float(count)) + 1e-4)
    decoder = BenchDecoder(SIM, {"rmcu": inserted(counted, status(count))}, {"rmcu": "1"})
    recorder = decoder.write(tmp_path / "a.mcap", 0)
    recording = recorder.finish_rows()
    recorder.writer.close()
    assert set(recording.channels) == {
        "time_s",
        "motor_speed_rad_s",
        "motor_torque_ref_nm",
        "motor_torque_nm",
        "driving_torque_ref_nm",
        "driving_torque_est_nm",
    }
    assert len(recording.time_s) == count - 1  # the first came before anything had been counted
    np.testing.assert_allclose(recording["driving_torque_ref_nm"], 5.0, atol=0.1)
    assert set(decoder.attachments) == {"bench.toml", "device/rmcu/rmcu.dbc"}
    raw = read_frames(tmp_path / "a.mcap")["rmcu"]
    assert raw["id"].tolist() == [LAYOUTS["RMCU_Status"].id, control.id] * count  # each once, in order


def test_without_the_frames_that_count_there_are_no_rows(tmp_path: Path) -> None:
    with pytest.raises(BadInputError, match="which gives the time base"):
        BenchDecoder(SIM, {"rmcu": status(10)}, {"rmcu": "1"}).write(tmp_path / "a.mcap", 0)
