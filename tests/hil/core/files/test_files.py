"""Files are read and written whole, or the message says which and why."""

from __future__ import annotations

import contextlib
import errno
import os
import stat
from pathlib import Path

import pytest

from hil.core.errors import BadInputError, BenchError
from hil.core.files import (
    make_directory,
    of_the_system,
    open_regular,
    read_bytes,
    read_text,
    refuse_special,
    replacing,
    sha256_of,
    write_atomically,
)


def test_a_file_is_whole_or_not_there(tmp_path: Path) -> None:
    path = tmp_path / "new" / "a.txt"
    write_atomically(path, "ω_m")
    assert read_text(path) == "ω_m"
    assert stat.S_IMODE(path.stat().st_mode) == 0o644
    with contextlib.suppress(RuntimeError), replacing(path) as temporary:
        temporary.write_text("half")
        raise RuntimeError
    assert read_text(path) == "ω_m"
    assert list(path.parent.iterdir()) == [path]


def test_a_failure_is_told_in_the_systems_words_alone(tmp_path: Path) -> None:
    with pytest.raises(BadInputError) as caught:
        read_text(tmp_path / "none.toml")
    assert caught.value.what == "No such file or directory"
    assert caught.value.where == str(tmp_path / "none.toml")
    assert of_the_system(OSError("odd")).what == "odd"
    assert of_the_system(OSError(errno.EACCES, "Permission denied", "x")).what == "Permission denied"
    (tmp_path / "latin").write_bytes(b"\xe9")
    with pytest.raises(BadInputError, match="not a UTF-8 text file"):
        read_text(tmp_path / "latin")


@pytest.mark.parametrize(
    ("number", "kind"),
    [
        (errno.ENOSPC, BenchError),
        (errno.EDQUOT, BenchError),
        (errno.EFBIG, BenchError),
        (errno.EIO, BenchError),
        (errno.EACCES, BadInputError),
        (errno.ENOENT, BadInputError),
    ],
)
def test_a_full_or_broken_disk_is_the_benchs_fault(
    tmp_path: Path, number: int, kind: type[Exception]
) -> None:
    with pytest.raises(kind, match="cannot be written: why"), replacing(tmp_path / "a"):
        raise OSError(number, "why")
    assert type(of_the_system(OSError(number, "why"))) is kind


def test_what_is_no_regular_file_is_not_replaced(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to(tmp_path / "nothing")
    for path, said in (
        (tmp_path, "is a directory"),
        (Path("/dev/null"), "is not a regular file"),
        (tmp_path / "link", "is a link to a missing file"),
    ):
        with pytest.raises(BadInputError, match=said):
            refuse_special(path)
    (tmp_path / "file").write_text("")
    with pytest.raises(BadInputError, match="cannot be made a directory: "):
        make_directory(tmp_path / "file" / "below")


def test_what_is_no_regular_file_is_refused_without_being_opened(tmp_path: Path) -> None:
    (tmp_path / "zero").symlink_to("/dev/zero")
    os.mkfifo(tmp_path / "pipe")
    for name, kind in (("zero", "a device"), ("pipe", "a pipe"), (".", "a directory")):
        for read in (read_text, read_bytes, open_regular, sha256_of):
            with pytest.raises(BadInputError) as caught:
                read(tmp_path / name)  # a pipe that were opened would wait for a writer for ever
            assert caught.value.what == f"is {kind}, not a file"


def test_no_more_is_read_than_a_file_of_the_kind_may_have(tmp_path: Path) -> None:
    path = tmp_path / "long.toml"
    path.write_text("0123456789")
    assert read_text(path, 10) == "0123456789"
    with pytest.raises(BadInputError, match=r"has more than 9e-06 MB"):
        read_bytes(path, 9)
    with path.open("wb") as file:
        file.truncate(1 << 40)  # holes: no room on the disk
    with pytest.raises(BadInputError, match=r"long\.toml: has more than 64 MB"):
        read_text(path)
