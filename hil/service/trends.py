"""How a criterion went from run to run, and how far it stays from its limits compared with its scatter."""

from __future__ import annotations

import itertools
import math
import statistics
from collections.abc import Iterable, Sequence

from hil.api_schemas.api import TrendData, TrendPoint, TrendSignal
from hil.service.control_chart import TEXTS, signals
from test_plans import CHECKS

#: Mean range of two values of a normal distribution, in standard deviations (ISO 7870-2, d2 for n = 2).
_RANGE_OF_TWO = 1.128
LEAST_POINTS = 5
#: Variance of a standard deviation from moving ranges, times the number of ranges, in variances of the values
#: (Cryer & Ryan, Journal of Quality Technology 22, 1990): 0.5 it would be of the usual one.
_OF_RANGES = 0.826
_IN_95 = 1.959964  # standard deviations


def trends(points: Iterable[tuple[str, TrendPoint]]) -> list[TrendData]:
    """Trends by criterion, in the order in which criteria come first, the checks of any device last.

    Points are in the order of their runs.
    """
    by_criterion: dict[str, list[TrendPoint]] = {}
    for criterion, point in points:
        by_criterion.setdefault(criterion, []).append(point)
    ordered = sorted(by_criterion, key=lambda criterion: criterion.rpartition(".")[2] in CHECKS)
    return [_trend(criterion, by_criterion[criterion]) for criterion in ordered]


def _trend(criterion: str, points: list[TrendPoint]) -> TrendData:
    newest = points[-1]
    values = [point.value for point in points if point.value is not None]
    mean = statistics.fmean(values) if values else None
    deviation = _deviation(values)
    cpk = _cpk(mean, deviation, newest.upper, newest.lower)
    reach = _reach(cpk, len(values))
    return TrendData(
        criterion=criterion,
        unit=newest.unit,
        upper=newest.upper,
        lower=newest.lower,
        points=points,
        mean=mean,
        deviation=deviation,
        cpk=cpk,
        count=len(values),
        cpk_lower=None if cpk is None or reach is None else cpk - reach,
        cpk_upper=None if cpk is None or reach is None else cpk + reach,
        signals=_signals([point for point in points if point.value is not None], mean, deviation),
    )


def _signals(points: Sequence[TrendPoint], mean: float | None, deviation: float | None) -> list[TrendSignal]:
    if mean is None or deviation is None:
        return []
    values = [point.value for point in points if point.value is not None]
    return [
        TrendSignal(
            rule=one.rule,
            text=TEXTS[one.rule],
            runs=[point.run for point in points[one.first : one.last + 1]],
            present=one.last == len(points) - 1,
        )
        for one in signals(values, mean, deviation)
    ]


def _deviation(values: Sequence[float]) -> float | None:
    """From the differences of neighbours, so that a drift counts as drift and not as scatter."""
    if len(values) < LEAST_POINTS:
        return None
    ranges = [abs(after - before) for before, after in itertools.pairwise(values)]
    return statistics.fmean(ranges) / _RANGE_OF_TWO


def _cpk(
    mean: float | None, deviation: float | None, upper: float | None, lower: float | None
) -> float | None:
    """Distance of the mean to the nearer limit in units of three standard deviations."""
    rooms = [upper - mean] if upper is not None and mean is not None else []
    rooms += [mean - lower] if lower is not None and mean is not None else []
    return min(rooms) / (3 * deviation) if rooms and deviation else None


def _reach(cpk: float | None, count: int) -> float | None:
    """Half of Cpk's 95 % interval: Bissell's (Applied Statistics 39, 1990), for a deviation from ranges."""
    if cpk is None:
        return None
    return _IN_95 * math.sqrt(1 / (9 * count) + cpk**2 * _OF_RANGES / (count - 1))
