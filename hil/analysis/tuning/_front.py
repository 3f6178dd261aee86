"""What can be traded for what: candidates that none beats in peak, band energy and response time at once."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from hil.analysis.tuning._trial import Tried
from test_plans import Criterion

#: Metrics that the front is of, where criteria have them.
PEAK, BAND = "peak_shaft_torque", "band_energy_motor_speed"
RESPONSE = "response_time"


@dataclass(frozen=True)
class Point:
    """The largest of each metric over the driven segments, in its unit, and the longest response time, s."""

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
    slowest = max((value for one, value in tried.figures.items() if one.name == RESPONSE), default=np.inf)
    return Point(tried, (*figures, slowest)) if np.isfinite(slowest) else None


def within_hard_limits(tried: Tried) -> bool:
    """Whether it was run and keeps the hard limits, however much worse than the start it is."""
    return bool(tried.margins) and all(
        room >= 0.0 for name, room in tried.limits.items() if not name.startswith("keep.")
    )


def front_of(archive: Iterable[Tried], criteria: Sequence[Criterion]) -> tuple[Point, ...]:
    """Candidates within the hard limits that no other is as good as in every figure, by rising first figure.

    Those that get worse than the start by more than may be are among them: the front shows what that costs.
    """
    points = [point for one in archive if within_hard_limits(one) and (point := point_of(one, criteria))]
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
