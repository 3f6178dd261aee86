"""Cut anywhere, any bit flipped: what is recovered was written so, and what was lost is stated."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader

from hil.core.errors import BadInputError
from hil.core.recording import missing_of, read_frames, read_recording, recover_recording
from tests.hil.core.recording.test_damage import NAMES, write


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("whole") / "r.mcap"
    write(path)
    return path


def rows(path: Path) -> set[bytes]:
    recording = read_recording(path, least_samples=0, allow_missing=True)
    return {row.tobytes() for row in np.column_stack([recording[name] for name in NAMES])}


def check(content: bytes, whole: Path) -> str:
    """Recover what is left; `refused`, or `recovered` with nothing in it that was not written."""
    source, out = whole.with_name("broken.mcap"), whole.with_name("out.mcap")
    source.write_bytes(content)
    out.unlink(missing_ok=True)
    try:
        read = read_recording(source, least_samples=0, allow_missing=True)
        recovered = recover_recording(source, out)
    except BadInputError as error:
        assert str(source) in str(error)
        assert not out.exists()
        return "refused"
    assert source.read_bytes() == content
    assert recovered.damage == read.damage  # and none of its own
    assert rows(out) <= rows(whole)
    assert len(recovered.time_s) == len(read.time_s)
    assert np.all(np.diff(recovered.time_s) > 0)
    assert recovered.attachments == read.attachments
    frames, written = (read_frames(path)["rmcu"] for path in (out, whole))
    assert {frame.tobytes() for frame in frames} <= {frame.tobytes() for frame in written}
    with out.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        found = sum(1 for _ in reader.iter_messages(topics="/channels"))
        assert found == len(recovered.time_s)
        assert reader.get_summary().statistics.message_count >= found
    return "recovered"


@given(st.floats(0.0, 1.0))
@example(0.999999)
@example(0.5)
@settings(max_examples=40, deadline=None)
def test_cut_at_any_byte(whole: Path, share: float) -> None:
    content = whole.read_bytes()
    at = int(share * (len(content) - 1))
    assert check(content[:at], whole) == "recovered" or share < 0.5


@given(st.floats(0.0, 1.0, exclude_max=True), st.integers(0, 7))
@settings(max_examples=40, deadline=None)
def test_any_bit_flipped(whole: Path, share: float, bit: int) -> None:
    content = bytearray(whole.read_bytes())
    content[int(share * len(content))] ^= 1 << bit
    check(bytes(content), whole)


@given(st.floats(0.0, 0.9), st.binary(min_size=1, max_size=3000), st.floats(0.5, 1.0))
@settings(max_examples=25, deadline=None)
def test_overwritten_and_cut(whole: Path, share: float, rubbish: bytes, end: float) -> None:
    content = bytearray(whole.read_bytes())
    at = int(share * len(content))
    content[at : at + len(rubbish)] = rubbish
    check(bytes(content[: int(end * len(content))]), whole)


def test_what_is_missing_is_told_and_stays_told(whole: Path, tmp_path: Path) -> None:
    content = bytearray(whole.read_bytes())
    middle = len(content) // 2
    content[middle : middle + 40] = bytes(40)  # a block of samples
    (tmp_path / "cut.mcap").write_bytes(content[: int(0.8 * len(content))])
    once = recover_recording(tmp_path / "cut.mcap", tmp_path / "once.mcap")
    missing = missing_of(once)
    assert len(missing.gaps_s) == 1
    assert 0.0 < missing.seconds < 0.2
    assert missing.files == ("bench.toml", "run.json")
    assert any("are lost" in text for text in once.damage)
    assert any("cut off" in text for text in once.damage)
    assert once.metadata["recovery"]["from"] == "cut.mcap"
    assert len(once.metadata["recovery"]["from_sha256"]) == 64
    again = recover_recording(tmp_path / "once.mcap", tmp_path / "again.mcap")
    assert again.damage == once.damage
