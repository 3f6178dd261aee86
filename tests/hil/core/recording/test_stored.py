"""A recording that stays in its file gives the same as one that is held."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil.core.channels import TIME
from hil.core.errors import BadInputError
from hil.core.recording import Recording, RecordingWriter, missing_of, read_recording, write_recording
from hil.core.recording._stored import StoredColumns

NAMES = [TIME, "motor_torque_ref_nm", "motor_speed_rad_s", "shaft_torque_nm", "oil_temperature"]
SAMPLES = 5000


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A recording with a gap in time, single cells missing, and a slow device."""
    rows = np.random.default_rng(0).standard_normal((SAMPLES, len(NAMES)))
    rows[:, 0] = np.round(np.arange(SAMPLES) * 1e-3, 9)
    rows[3000:, 0] += 0.25
    rows[[0, 17, 18, 2999, 4999], 2] = np.nan
    rows[np.arange(SAMPLES) % 10 != 0, 4] = np.nan
    file = tmp_path_factory.mktemp("stored") / "r.mcap"
    writer = RecordingWriter(file, NAMES, ["rmcu"], chunk_bytes=4096)
    for start in range(0, SAMPLES, 100):
        writer.add_rows(rows[start : start + 100])
        writer.add_event(1e-3 * start, "note", f"row {start}")
    writer.describe("dut", {"name": "axle"})
    writer.close()
    return file


@pytest.fixture(scope="module")
def held(path: Path) -> Recording:
    return read_recording(path)


@pytest.fixture(scope="module")
def stored(path: Path) -> Recording:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("hil.core.recording._stored.MOST_HELD_BYTES", 1000)
        recording = read_recording(path)
    assert isinstance(recording.channels, StoredColumns)
    return recording


def assert_same(one: Recording, other: Recording) -> None:
    assert list(one.channels) == list(other.channels)
    for name in one.channels:
        assert np.array_equal(one[name], other[name], equal_nan=True), name


def test_channels_and_what_stands_beside_them_are_the_same(held: Recording, stored: Recording) -> None:
    assert_same(held, stored)
    assert (held.notes, held.damage, held.events) == (stored.notes, stored.damage, stored.events)
    assert held.notes == ["5 missing cells of 'motor_speed_rad_s' were interpolated"]
    assert missing_of(held) == missing_of(stored)
    assert stored.sample_time_s == pytest.approx(held.sample_time_s, rel=1e-9)
    assert (stored.samples, stored.first_s, stored.last_s) == (SAMPLES, held.first_s, held.last_s)


@given(
    start_s=st.floats(-1, 7),
    lasts_s=st.floats(0, 6),
    few=st.booleans(),
    inside=st.tuples(*[st.floats(0, 1)] * 2),
)
def test_stretches_are_the_same(
    held: Recording, stored: Recording, start_s: float, lasts_s: float, few: bool, inside: tuple[float, float]
) -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("hil.core.recording._stored.MOST_HELD_BYTES", 1 << 30 if few else 1000)
        one, other = (r.between(start_s, start_s + lasts_s) for r in (held, stored))
        assert isinstance(other.channels, dict) or not few
        assert_same(one, other)
        first, last = sorted(round(share * one.samples) for share in inside)
        assert_same(one.piece(first, last), other.piece(first, last))
        for or_at in (False, True):
            assert one.rows_before(start_s + 0.5, or_at=or_at) == other.rows_before(
                start_s + 0.5, or_at=or_at
            )


def test_blocks_make_up_the_whole(held: Recording, stored: Recording) -> None:
    for recording in (held, stored):
        firsts, blocks = zip(*recording.blocks((TIME, "shaft_torque_nm"), 777), strict=True)
        assert firsts == tuple(range(0, SAMPLES, 777))
        assert np.array_equal(np.concatenate([b["shaft_torque_nm"] for b in blocks]), held["shaft_torque_nm"])


def test_channels_can_be_added_and_left_out(stored: Recording) -> None:
    part = stored.without(["shaft_torque_nm"])
    part.channels["angle"] = np.arange(SAMPLES, dtype=float)
    assert "shaft_torque_nm" in stored
    assert "shaft_torque_nm" not in part
    assert "angle" not in stored
    with pytest.raises(BadInputError, match="has no channel 'shaft_torque_nm'"):
        part.rows(0, 1, ["shaft_torque_nm"])
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("hil.core.recording._stored.MOST_HELD_BYTES", 1000)
        piece = part.piece(100, 200)
    assert np.array_equal(piece["angle"], np.arange(100.0, 200.0))


def test_another_process_can_read_it(stored: Recording) -> None:
    assert_same(pickle.loads(pickle.dumps(stored)), stored)


@pytest.mark.parametrize("ending", [".csv", ".parquet", ".mf4", ".mat"])
def test_exports_are_the_same(
    held: Recording, stored: Recording, ending: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("hil.core.recording._table.BLOCK", 1234)
    monkeypatch.setattr("hil.core.recording._table.MOST_HELD_BYTES", 80_000)
    for name, recording in (("held", held), ("stored", stored)):
        write_recording(recording, tmp_path / f"{name}{ending}")
    one, other = (read_recording(tmp_path / f"{name}{ending}") for name in ("held", "stored"))
    assert_same(one, other)
    assert one.samples == SAMPLES
    assert (one.metadata, one.events) == (other.metadata, other.events) == (held.metadata, held.events)


def test_a_file_that_is_not_what_it_was_is_refused(path: Path, tmp_path: Path) -> None:
    copy = tmp_path / "r.mcap"
    copy.write_bytes(path.read_bytes())
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("hil.core.recording._stored.MOST_HELD_BYTES", 1000)
        recording = read_recording(copy)
    copy.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    with pytest.raises(BadInputError, match="was changed while it was being read"):
        recording["shaft_torque_nm"]


def test_a_damaged_file_loses_the_same(path: Path, tmp_path: Path) -> None:
    torn = bytearray(path.read_bytes())
    torn[len(torn) // 2] ^= 0xFF
    (tmp_path / "torn.mcap").write_bytes(torn)
    held = read_recording(tmp_path / "torn.mcap")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("hil.core.recording._stored.MOST_HELD_BYTES", 1000)
        stored = read_recording(tmp_path / "torn.mcap")
    assert held.damage
    assert held.damage == stored.damage
    assert_same(held, stored)
