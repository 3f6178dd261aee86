"""Where emergency stops lie: where every account of the machine finds them, or with who simulates a bench."""

from __future__ import annotations

import atexit
import contextlib
import os
import secrets
import shutil
import tempfile
from pathlib import Path

from hil.core.errors import BadInputError
from hil.core.files import make_directory
from hil.engine.bench.bench_tables import BenchFile
from hil.engine.bench.bus_settings import within_process

FOLDER = "emergency-stops"
RESET = "reset"
#: One that outlives a power cut and that every account reads; /var/tmp is one that every account can make.
MACHINE_PLACES = (
    (Path(os.environ.get("PROGRAMDATA", r"C:\ProgramData")) / "hil",)
    if os.name == "nt"
    else (Path("/var/lib/hil"), Path("/var/tmp/hil"))
)
_ACCOUNTS = Path("/etc/passwd")  # read itself: to ask a directory service for all accounts may take minutes
_HOME_FIELD = 5
_STATE = Path(".local/state/hil")
_FOR_ALL = 0o1777  # as /tmp: all may write, each only takes away what is its own
_TOKEN = secrets.token_hex(6)


def places_to_write(file: BenchFile, owner: Path | None) -> list[Path]:
    """Where a stop of this bench is to be kept: the first that takes it.

    Args:
        owner: folder of the service or agent whose bench it is, if it is a simulated one.
    """
    if within_process(file):
        return [owner / FOLDER if owner is not None else _of_this_process()]
    named = os.environ.get("HIL_STATE")
    first = [Path(named)] if named else []
    return [place / FOLDER for place in (*first, *MACHINE_PLACES, own_place())]


def places_to_read(file: BenchFile, owner: Path | None) -> list[Path]:
    """Where a stop of this bench may have been kept, by whichever account."""
    if within_process(file):
        return places_to_write(file, owner)
    homes = [home / _STATE / FOLDER for home in _homes()]
    return list(dict.fromkeys([*places_to_write(file, owner), *homes]))


def seen_by_all(place: Path) -> bool:
    """Whether every account of the machine finds what lies there."""
    return place.parent in (*MACHINE_PLACES, Path(os.environ.get("HIL_STATE") or "/nowhere"))


def own_place() -> Path:
    """The account's own place for what outlives a process."""
    base = os.environ.get("XDG_STATE_HOME")
    return Path(base) / "hil" if base else _home() / _STATE


def make_for_all(place: Path) -> None:
    """Make a folder for stops, in a place of the machine's for all accounts.

    Raises:
        BadInputError: it cannot be made, or leads elsewhere.
    """
    if place.parent in MACHINE_PLACES and place.parent.is_symlink():
        raise BadInputError("is a link, which any account may have created", where=str(place.parent))
    if place == _of_this_process():
        atexit.register(_end_with, os.getpid(), place.parent)
    for folder in (place.parent, place, place / RESET):
        there = folder.is_dir()
        make_directory(folder, option="HIL_STATE")
        if not there and seen_by_all(place):
            with contextlib.suppress(OSError):  # made by another account at the same moment
                folder.chmod(_FOR_ALL)


def remark_on_place(file: BenchFile) -> str:
    """What is to be known of where a stop of this bench would be kept; '' if every account would find it."""
    if within_process(file):
        return ""
    places = places_to_write(file, None)
    found = next((place for place in places if _takes(place)), places[-1])
    return "" if seen_by_all(found) else _REMARK.format(place=found)


_REMARK = (
    "emergency stops are kept in {place}, which other accounts of this machine may not see; "
    f"an administrator can make a common directory: install -d -m 1777 {MACHINE_PLACES[0]}"
)


def remark_on(place: Path) -> str:
    """The same, of a place that was taken."""
    return _REMARK.format(place=place)


def _takes(place: Path) -> bool:
    """Whether files can be made there, or the folder itself."""
    while not place.exists() and place != place.parent:
        place = place.parent
    return place.is_dir() and os.access(place, os.W_OK | os.X_OK)


def _end_with(process: int, folder: Path) -> None:
    if os.getpid() == process:  # and not one that was forked from it
        shutil.rmtree(folder, ignore_errors=True)


def _of_this_process() -> Path:
    """A bench within a process ends with it, and so does its stop: no other process has its bench."""
    base = os.environ.get("HIL_STATE") or tempfile.gettempdir()
    return Path(base) / f"hil-process-{os.getpid()}-{_TOKEN}" / FOLDER


def _homes() -> list[Path]:
    """Homes of the machine's accounts, and of this one."""
    found = [_home()]
    with contextlib.suppress(OSError, UnicodeDecodeError):
        for line in _ACCOUNTS.read_text("utf-8").splitlines():
            fields = line.split(":")
            if len(fields) > _HOME_FIELD and fields[_HOME_FIELD].startswith("/"):
                found.append(Path(fields[_HOME_FIELD]))
    return list(dict.fromkeys(found))


def _home() -> Path:
    with contextlib.suppress(RuntimeError):
        return Path.home()
    return Path(tempfile.gettempdir())
