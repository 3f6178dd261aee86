"""Flipped bits, cut files and overwritten blocks: a recording is what was written, or says that it is not."""

import dataclasses
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader

from hil.core.can.frames import FRAME
from hil.core.errors import BadInputError
from hil.core.recording import Recording, RecordingWriter, driven_by_torque, read_frames, read_recording
from hil.core.result import RunResult, Segment

NAMES = ["time_s", "motor_torque_ref_nm", "motor_speed_rad_s", "wheel_speed_rad_s"]
SAMPLES = 600
SEGMENT = Segment(
    id="step", start_s=0.1, step_s=0.2, end_s=0.5, controller="phase", initial_speed_km_h=0, load="vehicle"
)
RUN = RunResult(
    verdict="pass",
    plan="small",
    bench="sim",
    real_time_factor=1.0,
    bench_time_s=0.6,
    safe_state="confirmed",
    criteria=(),
    segments=(SEGMENT,),
    files={},
)


def frames(start: int, count: int) -> np.ndarray:
    block = np.zeros(count, FRAME)
    block["time_s"] = np.arange(start, start + count) * 1e-3
    block["length"] = 8
    block["data"] = np.arange(count, dtype=np.uint64) * np.uint64(0x9E3779B97F4A7C15)
    return block


def write(path: Path) -> None:
    rows = np.random.default_rng(0).standard_normal((SAMPLES, len(NAMES)))
    rows[:, 0] = np.arange(SAMPLES) * 1e-3
    writer = RecordingWriter(path, NAMES, ["rmcu"], chunk_bytes=4096)
    writer.attach("plan.yaml", b"name: small\n")
    writer.describe("dut", {"name": "axle", "serial": "4711"})
    for start in range(0, SAMPLES, 50):
        writer.add_frames("rmcu", frames(start, 50))
        writer.add_rows(rows[start : start + 50])
        writer.add_event(start / 1000, "segment", "next")
    writer.attach("run.json", RUN.model_dump_json().encode())
    writer.describe("run", {"plan": "small"})
    writer.close()


@pytest.fixture(scope="module")
def original(tmp_path_factory) -> Recording:
    path = tmp_path_factory.mktemp("whole") / "r.mcap"
    write(path)
    read = read_recording(path)
    assert (read.damage, read.notes) == ([], [])
    return read


def check(content: bytes, original: Recording, path: Path) -> str:
    """What became of a changed file: `same`, `damage` or `refused`; nothing else may."""
    path.write_bytes(content)
    try:
        read = read_recording(path)
        read_frames(path)
    except BadInputError as error:
        assert str(path) in str(error)
        return "refused"
    if read.damage:
        assert not any("nan" in sentence for sentence in read.damage)
        return "damage"
    assert list(read.channels) == list(original.channels)
    for name, values in original.channels.items():
        np.testing.assert_array_equal(read[name], values)
    assert read.attachments == original.attachments
    assert read.metadata == original.metadata
    assert read.events == original.events
    return "same"


def flips(content: bytes, count: int) -> Iterator[bytes]:
    for bit in np.random.default_rng(1).integers(0, 8 * len(content), count).tolist():
        changed = bytearray(content)
        changed[bit // 8] ^= 1 << bit % 8
        yield bytes(changed)


def cuts(content: bytes, count: int) -> Iterator[bytes]:
    for end in np.random.default_rng(2).integers(0, len(content), count).tolist():
        yield content[:end]


def overwritten(content: bytes, count: int) -> Iterator[bytes]:
    rng = np.random.default_rng(3)
    for start in rng.integers(0, len(content), count).tolist():
        end = min(len(content), start + int(rng.integers(1, 3000)))
        yield content[:start] + rng.bytes(end - start) + content[end:]


def zeroed(content: bytes, count: int) -> Iterator[bytes]:
    for block in np.random.default_rng(4).integers(0, len(content) // 512, count).tolist():
        start, end = 512 * block, min(len(content), 512 * block + 2048)
        yield content[:start] + bytes(end - start) + content[end:]


MANY = pytest.mark.slow


@pytest.mark.parametrize(
    ("change", "count"),
    [
        (flips, 100),
        (cuts, 25),
        (overwritten, 25),
        (zeroed, 25),
        pytest.param(flips, 1000, marks=pytest.mark.hunt),
        pytest.param(cuts, 200, marks=MANY),
        pytest.param(overwritten, 200, marks=MANY),
        pytest.param(zeroed, 200, marks=MANY),
    ],
)
def test_a_changed_file_says_so_or_gives_what_was_written(change, count, original, tmp_path):
    content = original.source.read_bytes()
    found = [check(changed, original, tmp_path / "r.mcap") for changed in change(content, count)]
    assert found.count("damage") > count / 2


def chunk_starts(path: Path) -> list[int]:
    with path.open("rb") as file:
        summary = make_reader(file).get_summary()
    return [index.chunk_start_offset for index in summary.chunk_indexes]


def with_flip(path: Path, at: int, bit: int = 0) -> Path:
    content = bytearray(path.read_bytes())
    content[at] ^= 1 << bit
    changed = path.with_name(f"flip-{at}-{bit}.mcap")
    changed.write_bytes(bytes(content))
    return changed


@pytest.mark.parametrize("offset", [1, 5, 60])  # the block's length, its length upwards, its data
def test_a_damaged_block_is_skipped_alone_and_its_time_is_said(offset, original):
    chunk = chunk_starts(original.source)[3]
    read = read_recording(with_flip(original.source, chunk + offset, 2))
    assert len(read.damage) == 1
    from_s, to_s = map(float, re.findall(r"between ([\d.]+) s and ([\d.]+) s are lost", read.damage[0])[0])
    time = original.time_s
    kept = (time <= from_s) | (time >= to_s)
    assert 0.5 * SAMPLES < kept.sum() < SAMPLES
    for name in NAMES:
        np.testing.assert_array_equal(read[name], original[name][kept])
    assert read.attachments == original.attachments


def test_a_block_that_turns_into_another_kind_of_record_is_missed(original):
    read = read_recording(with_flip(original.source, chunk_starts(original.source)[3], 4))
    assert any(f"{SAMPLES} were written" in sentence for sentence in read.damage)


def test_the_first_block_takes_the_channels_names_with_it_and_the_index_gives_them_back(original):
    read = read_recording(with_flip(original.source, chunk_starts(original.source)[0] + 60))
    assert list(read.channels) == NAMES
    assert re.search(r"samples before 0\.\d+ s are lost", read.damage[0])


def test_a_damaged_attachment_is_not_handed_out(original):
    at = original.source.read_bytes().index(b"name: small")
    read = read_recording(with_flip(original.source, at))
    assert "plan.yaml" not in read.attachments
    assert read.damage == ["the attachment 'plan.yaml' is damaged (its checksum disagrees) and was left out"]
    np.testing.assert_array_equal(read.time_s, original.time_s)


def test_an_attachment_whose_record_is_gone_is_named(original):
    at = original.source.read_bytes().index(b"plan.yaml") - 4 - 16 - 9
    read = read_recording(with_flip(original.source, at, 6))
    assert "the attachment 'plan.yaml' is lost" in read.damage


def test_damaged_descriptive_data_are_said_and_the_samples_cleared(original):
    read = read_recording(with_flip(original.source, original.source.read_bytes().index(b"4711")))
    assert len(read.damage) == 1
    assert "descriptive data may be wrong; the samples agree" in read.damage[0]


def test_a_cut_file_says_where_it_ends(original, tmp_path):
    content = original.source.read_bytes()
    (tmp_path / "r.mcap").write_bytes(content[: chunk_starts(original.source)[4] + 100])
    read = read_recording(tmp_path / "r.mcap")
    assert read.damage == [f"the file was cut off after {read.time_s[-1]:.3f} s: what followed is lost"]


def test_samples_that_were_changed_with_their_checksums_disagree_with_their_hash(original, tmp_path):
    rows = np.zeros((10, len(NAMES)))
    rows[:, 0] = np.arange(10)
    writer = RecordingWriter(tmp_path / "r.mcap", NAMES, [])
    writer.add_rows(rows)
    writer.describe("channels", {"sha256": "0" * 64, "samples": "10"})
    writer._hash.update(b"another history")
    writer.close()
    assert "do not agree with their hash" in read_recording(tmp_path / "r.mcap").damage[0]


def test_damage_stays_with_every_part_of_a_recording(original):
    read = read_recording(with_flip(original.source, original.source.read_bytes().index(b"4711")))
    assert read.between(0.1, 0.2).damage == read.damage
    assert dataclasses.replace(read).damage == read.damage
    assert [part.damage for part in driven_by_torque(read)] == [read.damage]
