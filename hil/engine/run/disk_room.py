"""Room on the disk for a recording and its reports, looked at before a bench is touched."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path

from hil.core.errors import BadInputError
from hil.core.files import disk_of
from test_plans import Plan, estimate_duration_s

_BYTES_PER_SECOND = 250_000  # a recording takes some 190 kB for each second of bench time
_REPORT_BYTES = 16_000_000
_COMFORT = 2.0  # others write too, prompts and holds take time


def needed_bytes(plan: Plan) -> int:
    """What a run's files may take."""
    return int(estimate_duration_s(plan) * _BYTES_PER_SECOND) + _REPORT_BYTES


def refuse_too_little_room(plans: Sequence[Plan], out: Path, times: int = 1) -> None:
    """Refuse runs of `plans`, each so many times, for which the disk of folder `out` has no room.

    Raises:
        BadInputError: tells what is free and what may be needed, and names the disk.
    """
    place = out.resolve()
    while not place.exists():
        place = place.parent
    needed, free = times * sum(needed_bytes(plan) for plan in plans), shutil.disk_usage(place).free
    if free < needed:
        what = "the recording" if times * len(plans) == 1 else f"{times * len(plans)} runs"
        raise BadInputError(
            f"{free / 1e6:.0f} MB are free, {what} may need {needed / 1e6:.0f} MB: {disk_of(out)}",
            where=str(out),
            fix="free disk space, or choose another place with --out",
        )


def remark_on_room(plan: Plan, out: Path) -> str:
    """What whoever starts a run that only just fits should know; '' if there is room enough."""
    needed, free = needed_bytes(plan), shutil.disk_usage(out).free
    if free >= _COMFORT * needed:
        return ""
    return f"the run may need {needed / 1e6:.0f} MB of {free / 1e6:.0f} MB that are free: {disk_of(out)}"
