"""Whether the clocks of several logs fit each other: gaps, overlaps, another time zone."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from hil.core.can_logs import CanLog
from hil.core.errors import BadInputError
from hil.core.errors.wording import printable

_ZONE_STEP_S, _MOST_ZONE_S = 900, 26 * 3600  # zones differ by quarters of an hour, from -12 to +14 hours
_GAP_S = 60.0
_LATE_S = 0.1


@dataclass(frozen=True)
class _Span:
    """Seconds since 1970 of a log's first and last frame."""

    log: CanLog
    first_s: float
    last_s: float

    @property
    def name(self) -> str:
        return printable(self.log.path.name)

    def overlap_s(self, other: _Span, moved_s: float = 0.0) -> float:
        """How long both were recorded, if `other` were moved."""
        begin = max(self.first_s, other.first_s + moved_s)
        return min(self.last_s, other.last_s + moved_s) - begin


def shifted(logs: Sequence[CanLog], shifts_s: Mapping[str, float]) -> list[CanLog]:
    """Logs whose clocks were moved by what somebody stated, by file name.

    Raises:
        BadInputError: there is no such log.
    """
    names = {log.path.name for log in logs}
    for name in shifts_s:
        if name not in names:
            there = ", ".join(sorted(names))
            raise BadInputError(f"--shift {printable(name)}: no log has this name", fix=f"there is: {there}")
    return [_moved(log, shifts_s.get(log.path.name, 0.0)) for log in logs]


def _moved(log: CanLog, by_s: float) -> CanLog:
    if not by_s or log.began_ns is None:
        return log
    remarks = [*log.remarks, f"its clock was moved by {by_s:g} s, as stated"]
    return replace(log, began_ns=log.began_ns + round(by_s * 1e9), remarks=remarks)


def remarks_on_clocks(logs: Sequence[CanLog], stated: Mapping[str, float]) -> list[str]:
    """What lies between several logs, a sentence each.

    Args:
        stated: logs whose clock somebody has stated; these are taken as they are.

    Raises:
        BadInputError: two logs of different buses have no moment in common, and would have if one was written
            in another time zone.
    """
    spans = sorted(_spans(logs), key=lambda span: span.first_s)
    for one, other in itertools.combinations(spans, 2):
        if not {one.log.path.name, other.log.path.name} & stated.keys():
            _refuse_zone(one, other)
    remarks = []
    last_s, last = float("-inf"), ""
    for span in spans:
        if span.first_s - last_s > _GAP_S and last:
            remarks.append(
                f"between {last} and {span.name} lie {span.first_s - last_s:.6g} s without a frame"
            )
        if span.last_s > last_s:
            last_s, last = span.last_s, span.name
    return remarks


def refuse_overlap(parts: Sequence[tuple[str, float, float]], channel: str) -> None:
    """Refuse a channel of which two files have frames of the same time: two buses, or one recorded twice.

    Args:
        parts: file, and times in s of its first and last frame.

    Raises:
        BadInputError: names both files.
    """
    for one, other in itertools.pairwise(sorted(parts, key=lambda part: part[1])):
        overlap_s = min(one[2], other[2]) - other[1]
        if overlap_s > _LATE_S:
            raise BadInputError(
                f"channel '{printable(channel)}' of {printable(one[0])} and of {printable(other[0])} overlap "
                f"by {overlap_s:.3g} s: two buses, or one that was recorded twice",
                fix="pick one with --bus BUS=FILE:CHANNEL, replay them separately, or --shift FILE=SECONDS",
            )


def _spans(logs: Sequence[CanLog]) -> Iterator[_Span]:
    for log in logs:
        if log.began_ns is None:
            continue
        began_s = log.began_ns * 1e-9
        firsts = [float(block["time_s"][0]) for block in log.channels.values()]
        lasts = [float(block["time_s"][-1]) for block in log.channels.values()]
        yield _Span(log, began_s + min(firsts), began_s + max(lasts))


def _refuse_zone(one: _Span, other: _Span) -> None:
    """Parts of one drive have channels of one name; logs of different buses are of one time."""
    if one.log.channels.keys() & other.log.channels.keys() or one.overlap_s(other) >= 0:
        return
    apart_s = other.first_s - one.first_s
    moved_s = -round(apart_s / _ZONE_STEP_S) * _ZONE_STEP_S
    shorter_s = min(one.last_s - one.first_s, other.last_s - other.first_s)
    if moved_s and abs(moved_s) <= _MOST_ZONE_S and one.overlap_s(other, moved_s) > 0.5 * shorter_s:
        raise BadInputError(
            f"{one.name} and {other.name} are of different channels and have no moment in common; "
            f"{other.name} begins {apart_s:.6g} s later, and would overlap if its clock was moved by "
            f"{moved_s / 3600:+g} h, as of another time zone",
            fix=f"--shift {other.name}={moved_s}; if its clock is right: --shift {other.name}=0",
        )
