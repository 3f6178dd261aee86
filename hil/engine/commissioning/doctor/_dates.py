"""Calibration dates of the bench file against today."""

from __future__ import annotations

import datetime
from collections.abc import Iterator

from drivers import Finding
from hil.engine.bench.bench_tables import BenchFile

_SOON = datetime.timedelta(days=30)


def findings_of_dates(file: BenchFile, today: datetime.date) -> Iterator[Finding]:
    """Calibrations that have run out, or soon will; and that none is stated."""
    where = f"{file.source}, [calibration]"
    for sensor, until in file.calibration.items():
        if until < today:
            fix = "have it calibrated and enter the new date; runs are refused until then"
            yield Finding("fault", f"the calibration of '{sensor}' expired on {until}", where, fix)
        elif until - today <= _SOON:
            what = f"the calibration of '{sensor}' expires in {(until - today).days} days, on {until}"
            yield Finding("hint", what, where, "have it calibrated before that day; later runs are refused")
    if not file.calibration and file.simulation is None:
        fix = "enter the last valid day of the calibration for each sensor"
        yield Finding("hint", "no calibration dates are stated", str(file.source), fix)
