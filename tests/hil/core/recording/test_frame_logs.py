"""Raw frames as logs, read back by python-can and, decoded with a DBC, by asammdf."""

from __future__ import annotations

import datetime
import importlib
import warnings
from pathlib import Path
from typing import Any

import can
import cantools
import numpy as np
import pytest
from asammdf import MDF
from can.io import mf4

from hil.core.can.frames import ERROR_FRAME, EXTENDED, SENT_BY_HOST, frames, joined
from hil.core.errors import BadInputError
from hil.core.recording import DEVICE, RecordingWriter, read_recording, write_frames
from tests.benches_for_tests import SIM

NAMES = ["time_s", "motor_torque_ref_nm", "motor_speed_rad_s"]
BEGAN = datetime.datetime(2026, 3, 4, 9, 15, 0, 250_000, datetime.UTC)
BENCHES = SIM.rmcu.dbc.parent
DBC = cantools.database.load_file(BENCHES / "rmcu.dbc")
MEASURED = DBC.get_message_by_name("RMCU_Status")
SPEEDS = np.round(np.linspace(-40.0, 40.0, 50), 1)


def payload(speed: float) -> int:
    values = {signal.name: 0 for signal in MEASURED.signals} | {"MotorSpeed": speed}
    return int.from_bytes(MEASURED.encode(values, padding=True), "little")


@pytest.fixture
def recorded(tmp_path: Path) -> Path:
    """Two buses: decoded frames, one of the host's, an extended and an error frame."""
    path = tmp_path / "r.mcap"
    writer = RecordingWriter(path, NAMES, ["rmcu", "dyno"])
    speeds = np.array([payload(speed) for speed in SPEEDS], np.uint64)
    writer.add_frames(
        "rmcu", frames(MEASURED.frame_id, speeds, MEASURED.length, np.linspace(0.1, 0.149, len(SPEEDS)))
    )
    writer.add_frames(
        "dyno",
        joined(
            [
                frames(0x203, 0x0102030405060708, 8, 0.12, flags=SENT_BY_HOST),
                frames(0x1ABCDEF, 0xFF, 1, 0.13, flags=EXTENDED),
                frames(0, 0, 0, 0.14, flags=ERROR_FRAME),
            ]
        ),
    )
    writer.add_rows(np.column_stack([1e-3 * np.arange(10), np.zeros((10, 2))]))
    writer.attach(f"{DEVICE}rmcu/rmcu.dbc", (BENCHES / "rmcu.dbc").read_bytes())
    writer.describe("time", {"bench_clock_0_at": BEGAN.isoformat(timespec="milliseconds")})
    writer.close()
    return path


def read_back(path: Path) -> list[can.Message]:
    if path.suffix == ".mf4":  # not by LogReader, which leaves the file open
        if vars(mf4)["asammdf"] is None:  # commands import python-can without
            importlib.reload(mf4)
        with path.open("rb") as file, mf4.MF4Reader(file) as reader:
            return list(reader)
    with can.LogReader(path) as reader:
        return list(reader)


@pytest.mark.parametrize("ending", [".blf", ".asc", ".log", ".mf4"])
def test_python_can_reads_every_frame_back(recorded: Path, tmp_path: Path, ending: str) -> None:
    out = tmp_path / f"frames{ending}"
    assert write_frames(read_recording(recorded), out) == len(SPEEDS) + 3
    messages = read_back(out)
    data = [m for m in messages if m.arbitration_id == MEASURED.frame_id]
    assert [int.from_bytes(m.data, "little") for m in data] == [payload(speed) for speed in SPEEDS]
    start_s = 0.1 if ending == ".asc" else 0.0  # it counts from its first frame
    began_s = 0.0 if ending == ".asc" else BEGAN.timestamp()
    wanted_s = began_s - start_s + 0.1 + 1e-3 * np.arange(len(SPEEDS))
    np.testing.assert_allclose([m.timestamp for m in data], wanted_s, atol=2e-6)
    (sent,) = [m for m in messages if m.arbitration_id == 0x203]
    assert (sent.is_rx, sent.data) == (False, bytes([8, 7, 6, 5, 4, 3, 2, 1]))
    assert sent.channel != data[0].channel
    (extended,) = [m for m in messages if m.is_extended_id and not m.is_error_frame]
    assert (extended.arbitration_id, extended.dlc, extended.data[0]) == (0x1ABCDEF, 1, 0xFF)
    assert sum(m.is_error_frame for m in messages) == 1


def test_asammdf_decodes_the_bus_log_with_the_dbc_inside(recorded: Path, tmp_path: Path) -> None:
    out = tmp_path / "frames.mf4"
    write_frames(read_recording(recorded), out)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with MDF(out) as log:
            (attached,) = log.attachments
            dbc = tmp_path / attached.file_name
            dbc.write_bytes(log.extract_attachment(0)[0])
            assert log.header.start_time == BEGAN
            decoded: Any = log.extract_bus_logging({"CAN": [(dbc, 1)]})
            speed = decoded.get("MotorSpeed")
    np.testing.assert_allclose(speed.samples, SPEEDS, atol=1e-6)
    np.testing.assert_allclose(speed.timestamps, 0.1 + 1e-3 * np.arange(len(SPEEDS)), atol=1e-9)


def test_the_head_of_an_asc_log_has_the_day_of_the_run(recorded: Path, tmp_path: Path) -> None:
    write_frames(read_recording(recorded), tmp_path / "frames.asc")
    first = (tmp_path / "frames.asc").read_text().splitlines()[0]
    assert first == f"date {BEGAN.astimezone():%a %b %d %H:%M:%S}.250 2026"


def test_what_has_no_frames_is_refused_and_nothing_is_left(recorded: Path, tmp_path: Path) -> None:
    table = read_recording(recorded)
    table.source = tmp_path / "r.csv"
    with pytest.raises(BadInputError, match="no raw frames"):
        write_frames(table, tmp_path / "x.blf")
    with pytest.raises(BadInputError, match="ends in .blf, .asc, .log, .mf4"):
        write_frames(read_recording(recorded), tmp_path / "x.pcap")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["r.mcap"]
