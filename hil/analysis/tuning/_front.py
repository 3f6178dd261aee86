"""What can be traded for what: candidates that none beats in peak, band energy and sensitivity at once."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from hil.analysis.tuning._trial import Tried
from test_plans import Criterion

#: Metrics that the front is of, where criteria have them.
PEAK, BAND = "peak_shaft_torque", "band_energy_motor_speed"


@dataclass(frozen=True)
class Point:
    """The largest of each metric over the driven segments, in its unit, and the speed loop's |S|max."""

    tried: Tried
    figures: tuple[float, ...]


def metrics_of(criteria: Sequence[Criterion]) -> tuple[str, ...]:
    """Peak and band energy where criteria have them, else the first metrics that are judged; at most two."""
    names = list(dict.fromkeys(criterion.metric.name for criterion in criteria))
    wanted = [name for name in (PEAK, BAND) if name in names]
    return tuple([*wanted, *(name for name in names if name not in wanted)][:2])


def point_of(tried: Tried, criteria: Sequence[Criterion]) -> Point | None:
    """None where it was not run, or a metric has no value."""
    figures = []
    for metric in metrics_of(criteria):
        ids = {criterion.id for criterion in criteria if criterion.metric.name == metric}
        values = [result.value for result in tried.criteria if result.id in ids]
        known = [value for value in values if value is not None]
        if not known or len(known) < len(values):
            return None
        figures.append(max(known))
    return Point(tried, (*figures, tried.loop.sensitivity_peak))


def front_of(archive: Iterable[Tried], criteria: Sequence[Criterion]) -> tuple[Point, ...]:
    """The feasible candidates that no other is as good as in every figure, by rising first figure."""
    points = [point for tried in archive if tried.feasible and (point := point_of(tried, criteria))]
    if not points:
        return ()
    figures = np.array([point.figures for point in points])
    kept = []
    for number, own in enumerate(figures):
        as_good = np.all(figures <= own, axis=1) & np.any(figures < own, axis=1)
        twin = np.all(figures[:number] == own, axis=1)
        if not as_good.any() and not twin.any():
            kept.append(points[number])
    return tuple(sorted(kept, key=lambda point: point.figures))
