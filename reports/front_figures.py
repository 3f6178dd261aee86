"""What can be traded in a tuning: figures of merit of the candidates, those that none beats, named ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from hil.analysis.tuning import Tuning, front_of, metrics_of, point_of, within_hard_limits
from reports import labels
from reports.figure import Figure, Mark, Range, Trace
from reports.labels import Label

Array = npt.NDArray[np.float64]

_ROLES = ("gain", "phase", "third", "fifth")  # as in the responses
_SIGHT = 1.5  # times the largest of the named: what lies farther would flatten the rest
_ROOM = 0.08  # of what is shown, on either side


def front_figures(found: Tuning) -> tuple[Figure, ...]:
    """Second metric and response time over the first metric; empty with one metric alone."""
    criteria = found.trial.driven.criteria
    metrics = metrics_of(criteria)
    best = front_of(found.archive, criteria)
    every = [point for one in found.archive if within_hard_limits(one) and (point := point_of(one, criteria))]
    if len(metrics) < 2 or not best:
        return ()
    units = {criterion.metric.name: criterion.metric.unit for criterion in criteria}
    axes = [(name.replace("_", " ").capitalize(), units[name]) for name in metrics] + [("Response time", "s")]
    named = [(one.name, point.figures) for one in found.shown if (point := point_of(one.nominal, criteria))]
    clouds = (np.array([p.figures for p in every]), np.array([p.figures for p in best]))
    return tuple(
        replace(_figure(axes, pair, clouds, named), wide=pair == (1, 2)) for pair in ((0, 1), (0, 2), (1, 2))
    )


def within_sight(points: Array, named: Sequence[Sequence[float]]) -> npt.NDArray[np.bool_]:
    """Which points, shape (n, 3), lie so near to named ones that a picture may reach to them: (n,)."""
    if not len(named):
        return np.ones(len(points), bool)
    return np.asarray(np.all(points <= _SIGHT * np.max(np.array(named), axis=0), axis=1))


def _figure(
    axes: Sequence[tuple[str, str]],
    pair: tuple[int, int],
    clouds: tuple[Array, Array],
    named: Sequence[tuple[str, Sequence[float]]],
) -> Figure:
    every, best = clouds
    x, y = pair
    across, upwards = axes[x], axes[y]
    traces = [
        Trace(Label("candidates"), every[:, x], every[:, y], "reference", points=True),
        Trace(Label("Pareto front"), best[:, x], best[:, y], "fourth", points=True),
    ]
    marks = []
    for (name, point), role in zip(named, _ROLES, strict=False):
        where = f"{_value(point[x], across[1])}, {_value(point[y], upwards[1])}"
        marks.append(Mark(point[x], point[y], f"{name}: {where}", role))
    near = best[within_sight(best, [point for _, point in named])]
    shown = np.vstack([near[:, [x, y]], *([[p[x], p[y]]] for _, p in named)])
    return Figure(
        id=f"front-{y}" if x == 0 else f"front-{x}-{y}",
        title=Label(f"{upwards[0]} over {across[0].lower()}"),
        x_text=across[0],
        x_unit=across[1],
        y_label=Label(upwards[0]),
        y_unit=upwards[1],
        traces=tuple(traces),
        marks=tuple(marks),
        x_range=_range(shown[:, 0]),
        y_range=_range(shown[:, 1]),
        caption="○ " + "; ".join(mark.label for mark in marks) + "." if marks else "",
    )


def _value(value: float, unit: str) -> str:
    return labels.quantity(value, unit, significant=3)


def _range(values: Array) -> Range:
    """What is shown: the front and what is named; far candidates would flatten both."""
    low, high = float(values.min()), float(values.max())
    room = _ROOM * max(high - low, 1e-3 * abs(high), 1e-12)
    return low - room, high + room
