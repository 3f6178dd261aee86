"""The channels of a bench against what its file and a plan want of them, and sensors out of calibration.

An expired calibration is refused unless somebody answers by name and with a reason.
"""

from __future__ import annotations

import datetime
from collections.abc import Mapping, Sequence

from drivers import Stream
from hil.core.channels import TIME
from hil.core.errors import BadInputError
from hil.core.errors.wording import printable
from hil.core.result import AcceptedExpiry
from hil.engine.bench.bench_tables import BenchFile
from hil.engine.bench.computed_channels import TWIST
from hil.engine.bench.range_scan import unit_of
from hil.engine.bench.ranges import channels_of_magnitudes, slope_unit


def refuse_channels(file: BenchFile, streams: Sequence[Stream], missing: Mapping[str, str]) -> None:
    """Refuse channels that no recording can hold, that come twice, or are limited and do not come as stated.

    Args:
        missing: devices that cannot be opened, with why.

    Raises:
        BadInputError: which channel or key, and what to do.
    """
    given = _given(streams)
    limits = file.limits
    wanted = {f"limits.channels.{name}": name for name in limits.channels}
    wanted |= {f"limits.watch.{name}": named.channel for name, named in limits.watch.items()}
    wanted |= {f"interlocks.{name}": lock.channel for name, lock in file.interlocks.items()}
    wanted |= {f"zero.{name}": name for name in file.zero}
    for key, channel in wanted.items():
        if channel not in given:
            hint = "it is computed with [limits.twist]" if channel == TWIST else ""
            there = f"there are: {', '.join(given)}"
            raise _refused(
                file,
                f"{printable(key, 80)}: no device provides this channel",
                who_is_missing(missing) or hint or there,
            )
    _refuse_other_units(file, given)
    if not missing:
        _refuse_unwatched(file, given)


def _given(streams: Sequence[Stream]) -> dict[str, str]:
    """Each channel with its unit."""
    seen = {TIME: "the time base"}
    units: dict[str, str] = {}
    for stream in streams:
        for channel, unit in zip(stream.channels, stream.units, strict=True):
            if not (channel.isidentifier() and channel.isascii()):
                raise BadInputError(
                    f"a channel cannot be called '{printable(channel, 60)}'",
                    where=stream.where,
                    fix="use letters, digits and _, with the unit at the end: oil_temperature_k",
                )
            if channel in seen:
                raise BadInputError(
                    f"channel '{channel}' is also given by {seen[channel]}",
                    where=stream.where,
                    fix="every channel has one source; remove a device, or rename one of the channels",
                )
            seen[channel], units[channel] = stream.where, unit_of(channel, unit)
    return units


def _refuse_other_units(file: BenchFile, given: Mapping[str, str]) -> None:
    """A limit of 90 means something else in K than in degrees Celsius."""
    limits = file.limits
    stated = {
        f"limits.channels.{name}": (name, table.unit, table.of) for name, table in limits.channels.items()
    }
    stated |= {f"limits.watch.{name}": (t.channel, t.unit, t.of) for name, t in limits.watch.items()}
    stated |= {f"interlocks.{name}": (t.channel, t.unit, "value") for name, t in file.interlocks.items()}
    for key, (channel, unit, of) in stated.items():
        real = slope_unit(given[channel]) if of == "slope" else given[channel]
        if unit and real and unit.replace(" ", "") != real.replace(" ", ""):
            what = f"{printable(key, 80)}.unit = '{printable(unit)}': {channel} is in {real}"
            raise _refused(file, what, f"state the limit in {real}")


def _refuse_unwatched(file: BenchFile, given: Mapping[str, str]) -> None:
    """A limit that nothing is compared with limits nothing."""
    for key, ways in channels_of_magnitudes().items():
        if not any(all(channel in given for channel in way) for way in ways):
            wanted = ", or ".join(" and ".join(way) for way in ways)
            raise _refused(
                file,
                f"limits.{key}: the limit has no effect, because no device provides {wanted}",
                "add the device, or name its signals in the bench file; a limit needs a measured channel",
            )


def _refused(file: BenchFile, what: str, fix: str) -> BadInputError:
    return BadInputError(what, where=printable(file.source, 200), fix=fix)


def who_is_missing(missing: Mapping[str, str]) -> str:
    """Which devices, and why, for a message."""
    return printable("; ".join(f"devices.{name} is missing ({why})" for name, why in missing.items()), 400)


_FORM = "--accept-expired 'NAME: reason'"


def expired(bench: BenchFile, today: datetime.date) -> dict[str, str]:
    """Sensors whose calibration is no longer valid, and until when it was."""
    return {name: until.isoformat() for name, until in bench.calibration.items() if until < today}


def accepted_expiry(bench: BenchFile, today: datetime.date, accepted: str) -> AcceptedExpiry | None:
    """Who answers for sensors whose calibration has run out; None if none has.

    Args:
        accepted: "NAME: reason"; '': no one does.

    Raises:
        BadInputError: a calibration has run out and no one answers for it, or name or reason is missing.
    """
    by, _, reason = (part.strip() for part in accepted.partition(":"))
    if accepted and not (by and reason):
        raise BadInputError(
            f"'{printable(accepted, 80)}' lacks a name or a reason",
            where="--accept-expired",
            fix=f"write {_FORM}; the report prints both",
        )
    sensors = expired(bench, today)
    if not sensors:
        return None
    if not accepted:
        text = ", ".join(f"'{printable(name, 60)}' expired on {until}" for name, until in sensors.items())
        raise BadInputError(
            f"the calibration of {text}",
            where=printable(bench.source, 200),
            fix=f"calibrate it and enter the new date under [calibration]; or accept it by name: {_FORM}",
        )
    return AcceptedExpiry(by=by, reason=reason, sensors=sensors)
