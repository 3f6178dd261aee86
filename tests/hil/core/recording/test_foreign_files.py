"""Files of other tools, and things that are no files."""

import os
import threading
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from asammdf import MDF, Signal
from google.protobuf import descriptor_pb2
from mcap.writer import CompressionType, Writer

from hil.core.errors import BadInputError
from hil.core.recording import Recording, _schema, read_frames, read_recording, write_recording
from hil.core.recording._parquet import _column

NAMES = ["time_s", "motor_torque_ref_nm", "motor_speed_rad_s"]
ENDINGS = ["csv", "parquet", "mf4", "mcap", "mat"]
TIME = np.arange(100) / 1000


def refusal(path: Path) -> str:
    with pytest.raises(BadInputError) as caught:
        read_recording(path)
    assert path.name in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize("ending", ENDINGS)
def test_what_is_not_a_file_is_refused_and_never_waited_for(ending, tmp_path):
    directory, pipe, device, broken = (tmp_path / f"{n}.{ending}" for n in ("dir", "pipe", "dev", "link"))
    directory.mkdir()
    os.mkfifo(pipe)
    device.symlink_to("/dev/null")
    broken.symlink_to(tmp_path / "gone")
    before = set(threading.enumerate())
    assert "a directory" in refusal(directory)
    assert "a pipe" in refusal(pipe)
    assert "a device" in refusal(device)
    assert "a link to" in refusal(broken)
    assert set(threading.enumerate()) <= before


@pytest.mark.parametrize("ending", ENDINGS)
def test_an_empty_file_and_noise_are_refused(ending, tmp_path):
    for name, content in {"empty": b"", "noise": np.random.default_rng(0).bytes(5000)}.items():
        (tmp_path / f"{name}.{ending}").write_bytes(content)
        refusal(tmp_path / f"{name}.{ending}")


def parquet(tmp_path: Path, **columns) -> Path:
    table = {"time_s": TIME, "motor_torque_ref_nm": TIME, "motor_speed_rad_s": TIME} | columns
    pq.write_table(pa.table(table), tmp_path / "r.parquet")
    return tmp_path / "r.parquet"


@pytest.mark.parametrize(
    "column",
    [
        pa.array(["a"] * 100),
        pa.array([{"x": 1.0}] * 100),
        pa.array([[1.0, 2.0]] * 100),
        pa.array([b"x"] * 100),
    ],
)
def test_parquet_columns_that_are_not_numbers_are_refused_or_left_out(column, tmp_path):
    kind = str(column.type).partition("<")[0]
    assert f"column 'time_s': holds {kind}" in refusal(parquet(tmp_path, time_s=column))
    table = read_recording(parquet(tmp_path, own=column))
    assert "own" not in table
    assert "own" in table.notes[0]


@pytest.mark.parametrize(
    "column",
    [
        pa.array(range(100), pa.int16()),
        pa.array(range(100), pa.float32()),
        pa.array(range(100)).cast(pa.decimal128(20, 0)),
        pa.array(range(100)).dictionary_encode(),
    ],
)
def test_parquet_columns_of_any_kind_of_number_are_read(column, tmp_path):
    table = read_recording(parquet(tmp_path, own=column))
    np.testing.assert_array_equal(table["own"], np.arange(100))


def test_parquet_that_promises_more_rows_than_it_has_gives_none():
    batch = pa.record_batch({"own": pa.array([1.0, 2.0])})

    class Promising:
        metadata = SimpleNamespace(num_rows=3)

        def iter_batches(self, **options):
            yield batch

    with pytest.raises(ValueError, match="fewer rows than the file says"):
        _column(Promising(), "own")


def test_parquet_with_a_damaged_page_is_refused(tmp_path):
    rng = np.random.default_rng(0)
    channels = {"time_s": TIME} | {name: rng.standard_normal(100) for name in NAMES[1:]}
    write_recording(Recording(channels, tmp_path), tmp_path / "r.parquet")
    content = bytearray((tmp_path / "r.parquet").read_bytes())
    content[len(content) // 4] ^= 1
    (tmp_path / "r.parquet").write_bytes(bytes(content))
    assert "broken" in refusal(tmp_path / "r.parquet")


def mdf(tmp_path: Path, *groups: dict[str, tuple[Any, ...]]) -> Path:
    with MDF(version="4.10") as file:
        for group in groups:
            signals = [
                Signal(np.asarray(y), t, name=name, encoding="utf-8") for name, (t, y) in group.items()
            ]
            file.append(signals)
        file.save(tmp_path / "r.mf4", overwrite=True)
    return tmp_path / "r.mf4"


def test_mdf_groups_of_other_rates_come_to_the_inputs_time_stamps(tmp_path):
    slow = np.arange(0, 0.09, 0.01)
    path = mdf(
        tmp_path,
        {"wheel_speed_rad_s": (slow, 10 * slow), "state": (slow, np.array([b"on"] * len(slow)))},
        {"motor_torque_ref_nm": (TIME, TIME), "motor_speed_rad_s": (TIME, 2 * TIME)},
    )
    table = read_recording(path, allow_missing=True)
    np.testing.assert_array_equal(table.time_s, TIME)
    np.testing.assert_allclose(table["wheel_speed_rad_s"][:81], 10 * TIME[:81], atol=1e-12)
    assert np.isnan(table["wheel_speed_rad_s"][85:]).all()  # no value is made up beyond the last
    assert any("wheel_speed_rad_s" in note and "interpolated" in note for note in table.notes)
    assert any("state" in note for note in table.notes)


def test_mdf_channels_that_cannot_be_told_apart_are_refused(tmp_path):
    group = {"motor_torque_ref_nm": (TIME, TIME), "motor_speed_rad_s": (TIME, TIME)}
    assert "stands twice" in refusal(mdf(tmp_path, group, group))


def foreign_mcap(path: Path, schema: bytes, messages: list[bytes], *, encoding="protobuf", **options) -> Path:
    with path.open("wb") as file:
        writer = Writer(file, compression=CompressionType.NONE, **options)
        writer.start()
        schema_id = writer.register_schema("hil.Channels", encoding, schema)
        channels = writer.register_channel("/channels", encoding, schema_id)
        events = writer.register_channel("/events", "json", 0)
        frames = writer.register_channel("/can/rmcu", "protobuf", schema_id)
        for index, message in enumerate(messages):
            writer.add_message(channels, index, message, index)
        for event in (
            b"{",
            b"[]",
            b'"x"',
            b"\xff",
            b'{"time_s": NaN, "kind": "a", "text": "b"}',
            b"[" * 9999,
        ):
            writer.add_message(events, 0, event, 0)
        writer.add_message(frames, 0, b"\x0a\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\x01", 0)
        writer.finish()
    return path


def rows(count: int = 10) -> list[bytes]:
    table = np.zeros((count, len(NAMES)))
    table[:, 0] = np.arange(count)
    return [row.tobytes() for row in _schema.encode_rows(table)]


@pytest.mark.parametrize("options", [{}, {"enable_crcs": False}, {"use_chunking": False}])
def test_an_mcap_of_another_tool_is_read_with_or_without_checksums(options, tmp_path):
    path = foreign_mcap(tmp_path / "r.mcap", _schema.channels_schema(NAMES), rows(), **options)
    table = read_recording(path)
    assert table.time_s.tolist() == list(range(10))
    assert table.damage == []
    assert table.notes == ["6 events are not laid out as the project's and were left out"]
    with pytest.raises(BadInputError, match="raw frames"):
        read_frames(path)


def changed_schema(**change) -> bytes:
    files = descriptor_pb2.FileDescriptorSet.FromString(_schema.channels_schema(NAMES))
    for key, value in change.items():
        setattr(files.file[0].message_type[0].field[1], key, value)
    return files.SerializeToString()


@pytest.mark.parametrize(
    ("schema", "said"),
    [
        (changed_schema(type=descriptor_pb2.FieldDescriptorProto.TYPE_FLOAT), "is not one double"),
        (changed_schema(label=descriptor_pb2.FieldDescriptorProto.LABEL_REPEATED), "is not one double"),
        (changed_schema(number=7), "number 7 at place 2"),
        (changed_schema(name="time_s"), "stands twice"),
        (b"\xff\xff", "cannot be decoded"),
        (b"", "does not describe"),
    ],
)
def test_an_mcap_whose_channels_are_laid_out_otherwise_is_refused(schema, said, tmp_path):
    assert said in refusal(foreign_mcap(tmp_path / "r.mcap", schema, rows()))


def test_an_mcap_whose_channels_are_not_protobuf_is_refused(tmp_path):
    path = foreign_mcap(tmp_path / "r.mcap", b"{}", [b'{"time_s": 0}'], encoding="jsonschema")
    assert "not protobuf" in refusal(path)


@pytest.mark.parametrize(
    "message", [b"", b"\x09", rows(1)[0][:-1], rows(1)[0] + b"\x00", b"\x11" + rows(1)[0][1:]]
)
def test_a_message_that_is_not_laid_out_as_its_schema_says_is_refused(message, tmp_path):
    messages = [*rows(5), message, *rows(5)]
    assert "/channels" in refusal(foreign_mcap(tmp_path / "r.mcap", _schema.channels_schema(NAMES), messages))


def test_blocks_that_stand_twice_are_refused_as_time_that_runs_backwards(tmp_path):
    path = foreign_mcap(tmp_path / "r.mcap", _schema.channels_schema(NAMES), rows(5) + rows(5))
    assert "does not increase" in refusal(path)


def test_thousands_of_channels_are_read(tmp_path):
    names = ["time_s", "motor_torque_ref_nm", "motor_speed_rad_s", *[f"own_{i}" for i in range(2100)]]
    table = np.random.default_rng(0).standard_normal((3, len(names)))
    table[:, 0] = range(3)
    messages = [row.tobytes() for row in _schema.encode_rows(table)]
    read = read_recording(foreign_mcap(tmp_path / "r.mcap", _schema.channels_schema(names), messages))
    np.testing.assert_array_equal(read["own_2099"], table[:, -1])


@pytest.mark.parametrize("ending", ["parquet", "mf4"])
def test_numbers_that_are_no_measurement_are_refused_in_every_format(ending, tmp_path):
    channels = {name: TIME.copy() for name in NAMES}
    channels["motor_speed_rad_s"][7] = 1e200
    write_recording(Recording(channels, tmp_path), tmp_path / f"r.{ending}")
    assert "sample 8, column 'motor_speed_rad_s': 1e+200" in refusal(tmp_path / f"r.{ending}")
