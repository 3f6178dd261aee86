"""Calibration dates of the bench file against today."""

from __future__ import annotations

import datetime
from collections.abc import Iterator

from drivers import Finding
from hil.engine.bench_tables import BenchFile

_SOON = datetime.timedelta(days=30)


def findings_of_dates(file: BenchFile, today: datetime.date) -> Iterator[Finding]:
    """Calibrations that have run out, or soon will; and that none is stated."""
    where = f"{file.source}, [calibration]"
    for sensor, until in file.calibration.items():
        if until < today:
            fix = "have it calibrated and enter the new date; until then every run is refused"
            yield Finding("fault", f"the calibration of '{sensor}' ran out on {until}", where, fix)
        elif until - today <= _SOON:
            what = f"the calibration of '{sensor}' runs out in {(until - today).days} days, on {until}"
            yield Finding("hint", what, where, "make an appointment; a run after that day is refused")
    if not file.calibration and file.simulation is None:
        fix = "enter each sensor with the last day on which its calibration is valid"
        yield Finding("hint", "no calibration dates are stated", str(file.source), fix)
