import json
import resource
import signal
from typing import Any

import numpy as np
import pytest
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from hypothesis import given
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.records import Message
from mcap.stream_reader import StreamReader

from hil.core.can.frames import FRAME
from hil.core.errors import BadInputError, BenchError
from hil.core.recording import RecordingWriter, read_frames, read_recording

NAMES = ["time_s", "motor_torque_ref_nm", "motor_speed_rad_s", *[f"extra_{i}" for i in range(20)]]


def frames(count: int) -> np.ndarray:
    block = np.zeros(count, FRAME)
    block["time_s"] = np.arange(count) * 1e-3
    block["id"] = 0x110
    block["length"] = 8
    block["data"] = np.arange(count, dtype=np.uint64) << np.uint64(40)
    return block


def write(path, samples=3000):
    rows = np.random.default_rng(0).standard_normal((samples, len(NAMES)))
    rows[:, 0] = np.arange(samples) * 1e-3
    writer = RecordingWriter(path, NAMES, ["rmcu", "dyno"])
    for start in range(0, samples, 10):
        writer.add_frames("rmcu", frames(10))
        writer.add_rows(rows[start : start + 10])
    writer.add_event(1.5, "arm", "drives enabled")
    writer.attach("plan.yaml", b"name: x")
    writer.describe("dut", {"name": "axle"})
    writer.close()
    return rows


def test_frames_from_before_the_clock_began_keep_their_stamps(tmp_path):
    writer = RecordingWriter(tmp_path / "early.mcap", NAMES, ["rmcu"])
    early = frames(10)
    early["time_s"] -= 0.36
    writer.add_frames("rmcu", early)
    writer.add_rows(np.zeros((1, len(NAMES))))
    writer.close()
    np.testing.assert_array_equal(read_frames(tmp_path / "early.mcap")["rmcu"], early)


def test_messages_carry_the_time_of_day(tmp_path):
    """`log_time` counts from 1970, as other tools show it; stamps and `time_s` stay as they are."""
    began_ns = 1_800_000_000_123_000_000
    writer = RecordingWriter(tmp_path / "r.mcap", NAMES, ["rmcu"], clock_0_ns=began_ns)
    writer.row_0_s = 0.5
    writer.add_frames("rmcu", frames(10))
    writer.add_rows(np.array([[0.25] + [0.0] * (len(NAMES) - 1)]))
    writer.add_event(0.3, "arm", "drives enabled")
    writer.close()
    with (tmp_path / "r.mcap").open("rb") as file:
        logged = {c.topic: m.log_time for _, c, m in make_reader(file).iter_messages()}
    assert logged["/channels"] == began_ns + 750_000_000
    assert logged["/events"] == began_ns + 800_000_000
    assert logged["/can/rmcu"] == began_ns + 9_000_000
    np.testing.assert_array_equal(read_frames(tmp_path / "r.mcap")["rmcu"], frames(10))
    assert read_recording(tmp_path / "r.mcap", least_samples=1).time_s[0] == 0.25


def test_everything_comes_back(tmp_path):
    rows = write(tmp_path / "r.mcap")
    read = read_recording(tmp_path / "r.mcap")
    for column, name in enumerate(NAMES):
        np.testing.assert_array_equal(read[name], rows[:, column])
    assert read.attachments["plan.yaml"] == b"name: x"
    assert read.metadata["dut"] == {"name": "axle"}
    assert (read.events[0].time_s, read.events[0].kind) == (1.5, "arm")
    assert read.notes == []
    assert read.damage == []
    raw = read_frames(tmp_path / "r.mcap")
    np.testing.assert_array_equal(raw["rmcu"][:10], frames(10))
    assert len(raw["rmcu"]) == 3000
    assert len(raw["dyno"]) == 0


def test_other_readers_understand_the_schemas_in_the_file(tmp_path):
    rows = write(tmp_path / "r.mcap", samples=20)
    with (tmp_path / "r.mcap").open("rb") as file:
        messages = list(make_reader(file).iter_messages(topics=["/channels", "/can/rmcu", "/events"]))
    classes: dict[str, Any] = {}
    for schema, channel, message in messages:
        if channel.message_encoding == "json":
            assert json.loads(message.data)["kind"] == "arm"
            continue
        if schema.name not in classes:
            pool = descriptor_pool.DescriptorPool()
            for file in descriptor_pb2.FileDescriptorSet.FromString(schema.data).file:
                pool.Add(file)
            classes[schema.name] = message_factory.GetMessageClass(pool.FindMessageTypeByName(schema.name))
        decoded = classes[schema.name].FromString(message.data)
        if schema.name == "hil.Channels":
            sample = round(decoded.time_s * 1000)
            assert decoded.extra_19 == rows[sample, NAMES.index("extra_19")]
        else:
            assert list(decoded.data)[:10] == frames(10)["data"].tolist()
            assert decoded.length[:10] == b"\x08" * 10
    assert set(classes) == {"hil.Channels", "hil.CanFrames"}


def write_late(path, **options):
    """A run's way: frames at once, samples half a second later, an event in between."""
    writer = RecordingWriter(path, NAMES, ["rmcu", "dyno"], **options)
    for start_s in range(20):
        for part in range(20):
            block = frames(50)
            block["time_s"] += start_s + 0.05 * part
            for bus in ("rmcu", "dyno"):
                writer.add_frames(bus, block)
        rows = np.zeros((1000, len(NAMES)))
        rows[:, 0] = start_s + np.arange(1000) * 1e-3
        writer.add_event(start_s + 0.4321, "note", "in between")
        writer.add_rows(rows)
    writer.close()


def test_messages_lie_in_order_of_time_and_the_librarys_reader_finds_each(tmp_path):
    write_late(tmp_path / "r.mcap")
    with (tmp_path / "r.mcap").open("rb") as file:
        lying = [r for r in StreamReader(file, validate_crcs=True).records if isinstance(r, Message)]
        file.seek(0)
        reader = make_reader(file, validate_crcs=True)
        found = [message for _, _, message in reader.iter_messages()]
        one = [
            m
            for _, _, m in reader.iter_messages(
                topics="/events", starting_at=int(4e9), ending_before=int(6e9)
            )
        ]
        statistics = reader.get_summary().statistics
    times = [message.log_time for message in lying]
    assert times == sorted(times)
    assert found == lying
    assert [m.log_time for m in one] == [4_432_100_000, 5_432_100_000]
    assert statistics.message_count == len(lying) == sum(statistics.channel_message_counts.values())
    assert (statistics.message_start_time, statistics.message_end_time) == (times[0], times[-1])
    assert statistics.chunk_count > 10


def test_frames_do_not_wait_for_samples_for_ever(tmp_path):
    writer = RecordingWriter(tmp_path / "r.mcap", NAMES, ["rmcu"], chunk_bytes=10_000)
    writer.add_rows(np.zeros((1, len(NAMES))))
    for part in range(200):
        block = frames(50)
        block["time_s"] += 0.05 * part
        writer.add_frames("rmcu", block)
    left_by_a_crash = (tmp_path / "r.mcap").stat().st_size
    writer.close()
    assert left_by_a_crash > 10_000


@pytest.mark.parametrize("share", [0.3, 0.6, 0.9, 0.999])
def test_a_recording_that_was_cut_gives_what_is_whole_and_says_so(share, tmp_path):
    rows = write(tmp_path / "r.mcap")
    content = (tmp_path / "r.mcap").read_bytes()
    (tmp_path / "cut.mcap").write_bytes(content[: int(len(content) * share)])
    try:
        read = read_recording(tmp_path / "cut.mcap")
    except BadInputError as error:
        assert share < 0.5
        assert "broken" in str(error)
        return
    assert "cut off" in read.damage[-1]
    np.testing.assert_array_equal(read["time_s"], rows[: len(read.time_s), 0])


@given(st.integers(0, 60_000), st.integers(0, 255))
def test_a_broken_byte_never_gives_a_traceback(tmp_path_factory, position, value):
    path = tmp_path_factory.mktemp("broken") / "r.mcap"
    write(path, samples=50)
    content = bytearray(path.read_bytes())
    content[position % len(content)] = value
    path.write_bytes(bytes(content))
    try:
        read_recording(path)
    except BadInputError as error:
        assert str(path) in str(error)


def test_a_full_disk_is_a_bench_failure_with_advice(tmp_path):
    previous = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (50_000, limits[1]))
    try:
        with pytest.raises(BenchError, match="free disk space"):
            write(tmp_path / "r.mcap", samples=100_000)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        signal.signal(signal.SIGXFSZ, previous)
