from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from hil.app import results_folder as _results_folder
from hil.app.results_folder import refuse_file, results_in
from hil.core.errors import BadInputError

NAMES = ("summary.json", "a.txt")


def claim(out: Path | None, **options: Any) -> Any:
    return results_in(out, NAMES, summary="summary.json", **options)


def test_default_folders_are_numbered_and_never_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for number in ("001", "002", "003"):
        with results_in(None, NAMES, default="plan") as place:
            assert place.folder == Path(f"out/plan-{number}")
            place.write({"a.txt": b"x"})
    (tmp_path / "out/plan-0041").mkdir()
    with results_in(None, NAMES, default="plan") as place:
        assert place.folder.name == "plan-042"


def test_a_folder_that_stays_empty_is_removed_with_the_parents_made_for_it(tmp_path: Path) -> None:
    with pytest.raises(BadInputError, match="no good"), claim(tmp_path / "new" / "deep"):
        raise BadInputError("no good")
    assert list(tmp_path.iterdir()) == []


def test_results_are_refused_without_overwrite_and_replaced_whole_with_it(tmp_path: Path) -> None:
    old = {
        "summary.json": json.dumps({"files": ["a.txt", "old.svg"]}).encode(),
        "a.txt": b"1",
        "old.svg": b"2",
    }
    for name, content in old.items():
        (tmp_path / name).write_bytes(content)
    (tmp_path / "mine.txt").write_text("untouched")
    with (
        pytest.raises(BadInputError, match=r"holds results already: summary\.json") as caught,
        claim(tmp_path),
    ):
        raise AssertionError("was let in")
    assert "--overwrite" in str(caught.value)
    with results_in(tmp_path, NAMES, summary="summary.json", overwrite=True) as place:
        assert (tmp_path / "old.svg").exists()  # until the new results are there
        place.write({"summary.json": b"{}"})
    assert {p.name for p in tmp_path.iterdir()} == {"summary.json", "mine.txt"}


def test_an_input_is_never_written_over(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text("input")
    with (
        pytest.raises(BadInputError, match="is read by this command"),
        results_in(tmp_path, NAMES, inputs=[tmp_path / "a.txt"], overwrite=True),
    ):
        raise AssertionError("was let in")
    link = tmp_path / "link.txt"
    link.symlink_to(tmp_path / "a.txt")
    with pytest.raises(BadInputError, match="is read by this command"):
        refuse_file(link, [tmp_path / "a.txt"], overwrite=True)
    with results_in(tmp_path / "other", ("b",), inputs=[tmp_path / "a.txt"]) as place:
        (tmp_path / "other" / "late.txt").hardlink_to(tmp_path / "a.txt")
        with pytest.raises(BadInputError, match="is read by this command"):
            place.write({"b": b"", "late.txt": b""}, [tmp_path / "a.txt"])
        assert not (tmp_path / "other" / "b").exists()


def test_a_summary_cannot_send_overwrite_elsewhere(tmp_path: Path) -> None:
    (tmp_path / "precious").write_text("x")
    out = tmp_path / "out"
    out.mkdir()
    (out / "summary.json").write_text(json.dumps({"files": ["../precious", "/etc/hosts", 5]}))
    with results_in(out, NAMES, summary="summary.json", overwrite=True) as place:
        assert [p.name for p in place.stale] == ["summary.json"]
        place.remove_stale()
    assert (tmp_path / "precious").exists()


@pytest.mark.parametrize("content", ["", "[", "[]", "null", '{"files": 5}', '{"files": {"a": 1}}', "\x00"])
def test_a_broken_summary_lists_nothing(content: str, tmp_path: Path) -> None:
    (tmp_path / "summary.json").write_text(content)
    with results_in(tmp_path, NAMES, summary="summary.json", overwrite=True) as place:
        assert len(place.stale) == 1


def test_two_commands_do_not_write_to_one_folder(tmp_path: Path) -> None:
    other = (
        "import sys, pathlib\nfrom hil.app.results_folder import results_in\n"
        f"with results_in(pathlib.Path({str(tmp_path)!r}), ('b',)):\n"
        "    print('in', flush=True); sys.stdin.readline()\n"
    )
    with subprocess.Popen([sys.executable, "-c", other], stdin=-1, stdout=-1, text=True) as holder:
        assert holder.stdout is not None
        assert holder.stdout.readline() == "in\n"
        with pytest.raises(BadInputError, match="another command is writing here"), claim(tmp_path):  # type: ignore[attr-defined]
            raise AssertionError("was let in")
        holder.kill()  # the lock dies with its process
        holder.wait()
    with results_in(tmp_path, ("b",)):
        pass
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("out", ["file", "file/below", "/dev/null", "/proc/nowhere/out"])
def test_a_place_that_cannot_hold_results(out: str, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(BadInputError), results_in(tmp_path / out, NAMES):
        raise AssertionError("was let in")


@pytest.mark.parametrize("out", ["there.csv", "folder", "/dev/null", "/dev/full"])
def test_a_single_file_never_takes_the_place_of_something_else(out: str, tmp_path: Path) -> None:
    (tmp_path / "there.csv").write_text("x")
    (tmp_path / "folder").mkdir()
    with pytest.raises(BadInputError):
        refuse_file(tmp_path / out, [], overwrite=False)
    if out != "there.csv":
        with pytest.raises(BadInputError):
            refuse_file(tmp_path / out, [], overwrite=True)


def test_a_place_is_held_as_long_as_a_process_that_was_given_it_lives(tmp_path):
    with results_in(tmp_path, ("b",)) as place:
        heir = subprocess.Popen(
            [sys.executable, "-S", "-c", "input()"], stdin=subprocess.PIPE, pass_fds=[place.lock]
        )
    with pytest.raises(BadInputError, match="another command is writing here"), results_in(tmp_path, ("b",)):
        pass
    heir.communicate(b"\n")
    with results_in(tmp_path, ("b",)):
        pass


def test_the_folder_of_another_command_stays_when_both_come_at_the_same_moment(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Both have found that it is not there; each order of making and locking it."""
    out = tmp_path / "deep" / "out"
    holder = "from pathlib import Path; from hil.app.results_folder import results_in; import sys\n"
    holder += "with results_in(Path(sys.argv[1]), ['a.txt']) as place: print('in', flush=True); input()\n"
    other: list[subprocess.Popen[str]] = []
    make = Path.mkdir

    def made(path: Path, *arguments: Any, **options: Any) -> None:
        """Before or after this process makes it, another one takes it."""
        if first == "we":
            make(path, *arguments, **options)
        if path == out and not other:
            command = [sys.executable, "-c", holder, str(out)]
            other.append(subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True))
            assert other[0].stdout is not None
            assert other[0].stdout.readline() == "in\n"
        if first == "they":
            make(path, *arguments, **options)

    for order in ("we", "they"):
        first = order
        with monkeypatch.context() as patch:
            patch.setattr(Path, "mkdir", made)
            with pytest.raises(BadInputError, match="another command is writing here"), claim(out):
                pass
        assert out.is_dir()
        process = other.pop()
        process.communicate("\n", timeout=60)
        if out.exists():
            out.rmdir()


def test_a_folder_that_another_command_removes_meanwhile_is_made_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out, named = tmp_path / "out", _results_folder._named
    removed: list[Path] = []

    def gone_then(out: Path, made: list[Path]) -> Path:
        """Between making and locking it, twice."""
        folder = named(out, made)
        if len(removed) < 2:
            removed.append(folder)
            folder.rmdir()
        return folder

    monkeypatch.setattr(_results_folder, "_named", gone_then)
    with claim(out) as place:
        place.write({"a.txt": b"x"})
    assert len(removed) == 2
    assert (out / "a.txt").read_bytes() == b"x"
