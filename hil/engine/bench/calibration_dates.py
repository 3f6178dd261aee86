"""Sensors whose calibration has run out: refused, unless somebody answers by name and with a reason."""

from __future__ import annotations

import datetime

from hil.core.errors import BadInputError
from hil.core.errors.wording import printable
from hil.core.result import AcceptedExpiry
from hil.engine.bench.bench_tables import BenchFile

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
