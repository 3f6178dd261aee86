"""An emergency stop stays until a person resets it: no process arms the bench before, on no bench file."""

from __future__ import annotations

import contextlib
import datetime
import os
import secrets
from collections.abc import Iterator
from pathlib import Path

from pydantic import BaseModel, ConfigDict, ValidationError

from hil.core.errors import BenchError, EmergencyStopError, HilError, StopWay
from hil.core.files import make_directory, write_atomically
from hil.core.result import StoppedInEmergency
from hil.engine.bench_tables import BenchFile

_FOLDER = "emergency-stops"
_PLACE_FIX = "look at the file; it is removed with: hil reset {bench} --by NAME"


class LatchedStop(BaseModel):
    """An emergency stop as it is kept on disk, until `reset_by` is somebody; `origin`: from where it came."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    bench: str
    buses: tuple[str, ...]
    by: str
    why: str
    at: str
    run: str
    origin: str = ""
    way: StopWay = ""
    reset_by: str = ""
    reset_at: str = ""


def state_directory() -> Path:
    """Where is kept what outlives a process: HIL_STATE, or the user's own place for that."""
    own = os.environ.get("HIL_STATE")
    if own:
        return Path(own)
    base = os.environ.get("XDG_STATE_HOME")
    return Path(base) / "hil" if base else Path.home() / ".local" / "state" / "hil"


def buses_of(file: BenchFile) -> tuple[str, ...]:
    """What two bench files of one bench have in common, whatever they are called."""
    return tuple(
        sorted(
            " ".join([bus.interface, str(bus.channel), *(f"{k}={v}" for k, v in sorted(bus.options.items()))])
            for bus in file.buses.values()
        )
    )


def latch(file: BenchFile, *, by: str, why: str, run: Path, origin: str = "", way: StopWay = "") -> None:
    """Keep it on disk, also through a power cut.

    Raises:
        HilError: it cannot be written.
    """
    stop = LatchedStop(
        bench=file.name,
        buses=buses_of(file),
        by=by,
        why=why,
        at=_now(),
        run=str(run.resolve()),
        origin=origin,
        way=way,
    )
    folder = state_directory() / _FOLDER
    make_directory(folder)
    path = folder / f"{file.name[:60]}-{secrets.token_hex(6)}.json"
    write_atomically(path, stop.model_dump_json(indent=1) + "\n")
    with contextlib.suppress(OSError):  # a system that opens no folders
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)  # else its name could be gone after a power cut
        finally:
            os.close(handle)


def keep_latched(error: HilError | None, file: BenchFile, run: Path) -> StoppedInEmergency | None:
    """Latch the bench if an emergency stop ended the run; `error.fix` tells then what a person has to do."""
    if not isinstance(error, EmergencyStopError):
        return None
    error.fix = f"make sure that nobody is in danger; then: hil reset {file.source} --by NAME"
    latched = True
    try:
        latch(file, by=error.by, why=error.what, run=run, origin=error.origin, way=error.way)
    except (HilError, OSError) as failure:
        error.fix += (
            f"\n  it could NOT be latched, nothing but you keeps the bench from being armed: {failure}"
        )
        latched = False
    return StoppedInEmergency(
        by=error.by, why=error.what, latched=latched, origin=error.origin, way=error.way
    )


def refuse_latched(file: BenchFile) -> None:
    """Raises:
    BenchError: an emergency stop of this bench has not been reset: who, when, why, and how to reset it.
    """
    for path, stop in _latched(file):
        if stop is None:
            raise BenchError(
                "an emergency stop may be latched here, but cannot be read",
                where=str(path),
                fix=_PLACE_FIX.format(bench=file.source),
            )
        raise BenchError(
            f"emergency stop since {stop.at}, by {stop.by}: {stop.why}",
            where=f"bench '{file.name}'",
            fix=f"make sure that nobody is in danger and why it was; then: hil reset {file.source} --by NAME",
        )


def reset(file: BenchFile, by: str) -> list[LatchedStop]:
    """Let the bench be armed again; what was latched is kept beside, with who reset it.

    Raises:
        HilError: it cannot be written.
    """
    found = []
    for path, stop in list(_latched(file)):
        done = path.parent / "reset"
        make_directory(done)
        if stop is not None:
            stop = stop.model_copy(update={"reset_by": by, "reset_at": _now()})
            write_atomically(done / path.name, stop.model_dump_json(indent=1) + "\n")
            found.append(stop)
        else:
            write_atomically(done / path.name, path.read_bytes())
        path.unlink()
    return found


def _latched(file: BenchFile) -> Iterator[tuple[Path, LatchedStop | None]]:
    """Files of stops that concern a bench; without a stop if one cannot be read: it may concern any."""
    buses = set(buses_of(file))
    for path in sorted((state_directory() / _FOLDER).glob("[!.]*.json")):
        try:
            stop = LatchedStop.model_validate_json(path.read_bytes())
        except (OSError, ValidationError):
            yield path, None
            continue
        if buses & set(stop.buses):
            yield path, stop


def _now() -> str:
    return datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")
