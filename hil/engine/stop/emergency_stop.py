"""An emergency stop stays until a person resets it: no process arms the bench before, on no bench file."""

from __future__ import annotations

import contextlib
import datetime
import logging
import os
import secrets
from collections.abc import Iterator
from pathlib import Path

from pydantic import BaseModel, ConfigDict, ValidationError

from hil.core.errors import BenchError, EmergencyStopError, HilError, StopWay
from hil.core.files import write_atomically
from hil.core.result import StoppedInEmergency
from hil.engine.bench.bench_tables import BenchFile
from hil.engine.bench.bus_settings import identities_of, share_a_bus, within_process
from hil.engine.stop.stop_places import (
    RESET,
    make_for_all,
    places_to_read,
    places_to_write,
    remark_on,
    seen_by_all,
)

logger = logging.getLogger(__name__)

_BY_PORTS = (
    2  # `identity` of stops that name physical ports; earlier ones named interface, channel and options
)
_PLACE_FIX = "check the file; then: {reset}"


class LatchedStop(BaseModel):
    """An emergency stop as it is kept on disk, until `reset_by` is somebody; `origin`: from where it came."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    bench: str
    buses: tuple[str, ...]
    by: str
    why: str
    at: str
    run: str
    identity: int = 1
    origin: str = ""
    way: StopWay = ""
    reset_by: str = ""
    reset_at: str = ""


def buses_of(file: BenchFile) -> tuple[str, ...]:
    """What two bench files of one bench have in common, whatever they are called."""
    if within_process(file):
        return tuple(sorted(f"{bus.interface} {bus.channel}" for bus in file.buses.values()))
    return tuple(sorted(identities_of(file)))


def latch(
    file: BenchFile,
    *,
    by: str,
    why: str,
    run: Path,
    owner: Path | None = None,
    origin: str = "",
    way: StopWay = "",
) -> Path:
    """Keep it on disk, also through a power cut; the folder that it lies in.

    Args:
        owner: folder of the service or agent whose bench it is, if it is a simulated one.
        origin: from where it was asked for.
        way: by which way.

    Raises:
        HilError: it cannot be written anywhere.
    """
    stop = LatchedStop(
        bench=file.name,
        buses=buses_of(file),
        by=by,
        why=why,
        at=_now(),
        run=str(run.resolve()),
        identity=_BY_PORTS,
        origin=origin,
        way=way,
    )
    name = f"{file.name[:60]}-{secrets.token_hex(6)}.json"
    failure: HilError | OSError | None = None
    for place in places_to_write(file, owner):
        try:
            make_for_all(place)
            write_atomically(place / name, stop.model_dump_json(indent=1) + "\n")
        except (HilError, OSError) as error:
            failure = failure or error
            continue
        _put_name_on_disk(place)
        if not within_process(file) and not seen_by_all(place):
            logger.warning(remark_on(place))
        return place
    assert failure is not None
    raise failure


def _put_name_on_disk(folder: Path) -> None:
    with contextlib.suppress(OSError):  # a system that opens no folders
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)  # else its name could be gone after a power cut
        finally:
            os.close(handle)


def keep_latched(
    error: HilError | None, file: BenchFile, run: Path, owner: Path | None = None
) -> StoppedInEmergency | None:
    """Latch the bench if an emergency stop ended the run; `error.fix` says then what a person has to do."""
    if not isinstance(error, EmergencyStopError):
        return None
    error.fix = f"make sure that no one is in danger; then: {_how_to_reset(file, owner)}"
    latched = True
    try:
        place = latch(
            file, by=error.by, why=error.what, run=run, owner=owner, origin=error.origin, way=error.way
        )
        if not within_process(file) and not seen_by_all(place):
            error.fix += f"\n  {remark_on(place)}"
    except (HilError, OSError) as failure:
        error.fix += f"\n  it could NOT be latched, so nothing prevents arming the bench again: {failure}"
        latched = False
    return StoppedInEmergency(
        by=error.by, why=error.what, latched=latched, origin=error.origin, way=error.way
    )


def refuse_latched(file: BenchFile, owner: Path | None = None) -> None:
    """Raises:
    BenchError: an emergency stop of this bench has not been reset: who, when, why, and how to reset it.
    """
    for path, stop in _latched(file, owner):
        if stop is None:
            raise BenchError(
                "an emergency stop may be latched here, but cannot be read",
                where=str(path),
                fix=_PLACE_FIX.format(reset=_how_to_reset(file, owner)),
            )
        raise BenchError(
            f"emergency stop since {stop.at}, by {stop.by}: {stop.why}",
            where=f"bench '{file.name}'",
            fix=f"make sure that no one is in danger, remove the cause; then: {_how_to_reset(file, owner)}",
        )


def reset(file: BenchFile, by: str, owner: Path | None = None) -> list[LatchedStop]:
    """Let the bench be armed again; what was latched is kept beside, with who reset it.

    A stop of another account stays where it is, for it may not be removed: what stands beside it resets it.

    Raises:
        HilError: it cannot be written.
    """
    found = []
    for path, stop in list(_latched(file, owner)):
        record = path.read_bytes()
        if stop is not None:
            stop = stop.model_copy(update={"reset_by": by, "reset_at": _now()})
            record = (stop.model_dump_json(indent=1) + "\n").encode()
            found.append(stop)
        _keep_reset([path.parent, *places_to_write(file, owner)], path.name, record)
        with contextlib.suppress(PermissionError):
            path.unlink()
    return found


def _how_to_reset(file: BenchFile, owner: Path | None) -> str:
    if not within_process(file):
        return f"hil bench reset {file.source} --by NAME"
    if owner is not None:
        return f"reset it at its service, or: hil bench reset {file.source} --by NAME --data {owner}"
    return "start again: the bench is simulated in this process, and its stop ends with the process"


def _keep_reset(places: list[Path], name: str, record: bytes) -> None:
    """Write who reset a stop beside it, or where this account may write.

    Raises:
        HilError: nowhere.
    """
    failure: HilError | OSError | None = None
    for place in places:
        try:
            make_for_all(place)
            write_atomically(place / RESET / name, record)
        except (HilError, OSError) as error:
            failure = failure or error
        else:
            return
    assert failure is not None
    raise failure


def _latched(file: BenchFile, owner: Path | None) -> Iterator[tuple[Path, LatchedStop | None]]:
    """Files of stops that concern a bench; without a stop if one cannot be read: it may concern any."""
    buses, places = buses_of(file), places_to_read(file, owner)
    earlier = tuple(f"{bus.interface} {bus.channel}" for bus in file.buses.values())
    for path in (path for place in places for path in _stops_in(place)):
        try:
            content = path.read_bytes()
            stop = LatchedStop.model_validate_json(content)
        except FileNotFoundError:
            continue  # reset at this moment
        except OSError:
            yield path, None
            continue
        except ValidationError:
            if not any(_bytes_of(place / RESET / path.name) == content for place in places):
                yield path, None
            continue
        mine = buses if stop.identity == _BY_PORTS else earlier
        if share_a_bus(stop.buses, mine) and not any(_resets(place, path.name, stop) for place in places):
            yield path, stop


def _stops_in(place: Path) -> list[Path]:
    """Files of stops in a place, as far as this account can look into it."""
    try:
        found = sorted(place.iterdir())
    except OSError:
        return []
    return [path for path in found if path.suffix == ".json" and not path.name.startswith(".")]


def _resets(place: Path, name: str, stop: LatchedStop) -> bool:
    """Whether somebody has reset this very stop."""
    try:
        done = LatchedStop.model_validate_json(_bytes_of(place / RESET / name))
    except ValidationError:
        return False
    return bool(done.reset_by) and done.model_copy(update={"reset_by": "", "reset_at": ""}) == stop


def _bytes_of(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError:
        return b""


def _now() -> str:
    return datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")
