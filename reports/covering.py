"""Curves that swing so fast that the one drawn last covers the others: what is drawn are their envelopes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from reports.figure import Figure, Range, Trace

Array = npt.NDArray[np.float64]

#: Stretches of the x axis, each with its lowest and highest value.
STRETCHES = 160
_BOTH_WAYS = 1.5  # length of the path over its height from which a stretch swings
_VISIBLE = 0.02  # of the figure's height: lower swings look like one line
_MANY = 0.25  # of the stretches


@dataclass(frozen=True)
class Outline:
    """Lowest and highest value of a trace in each stretch, over the middle of the stretch."""

    x: Array
    low: Array
    high: Array


def outlines(figure: Figure) -> dict[int, Outline]:
    """By the number of the trace what is drawn in its place; empty unless two or more cover each other."""
    if figure.logarithmic or figure.logarithmic_x or len(figure.traces) < 2:
        return {}
    spans = [(t.y[np.isfinite(t.y)].min(), t.y[np.isfinite(t.y)].max()) for t in figure.traces if _drawn(t)]
    if not spans:
        return {}
    height = max(high for _, high in spans) - min(low for low, _ in spans)
    found = {
        number: outline
        for number, trace in enumerate(figure.traces)
        if _drawn(trace) and (outline := _outline(trace, figure, height)) is not None
    }
    return found if len(found) > 1 else {}


def shown_x(figure: Figure, covering: dict[int, Outline]) -> Range | None:
    """The range of x; of envelopes that of their curves, which reach to the ends of the outer stretches."""
    if figure.x_range is not None or not covering:
        return figure.x_range
    curves = [figure.traces[number].x for number in covering]
    return min(float(x[0]) for x in curves), max(float(x[-1]) for x in curves)


def _drawn(trace: Trace) -> bool:
    return not trace.points and int(np.isfinite(trace.y).sum()) > 4 * STRETCHES


def _outline(trace: Trace, figure: Figure, height: float) -> Outline | None:
    """None of a trace that swings in few stretches only."""
    start, end = figure.x_range or (float(trace.x[0]), float(trace.x[-1]))
    there = np.isfinite(trace.y) & (trace.x >= start) & (trace.x <= end)
    x, y = trace.x[there], trace.y[there]
    if len(x) < 2:
        return None
    edges = np.linspace(start, end, STRETCHES + 1)
    first = np.unique(np.searchsorted(x, edges[:-1]))
    first = first[first < len(x)]
    low, high = np.minimum.reduceat(y, first), np.maximum.reduceat(y, first)
    path = np.add.reduceat(np.abs(np.diff(y, append=y[-1])), first)
    swings = (path > _BOTH_WAYS * (high - low)) & (high - low > _VISIBLE * height)
    if np.mean(swings) < _MANY:
        return None
    last = np.append(first[1:], len(x)) - 1
    return Outline((x[first] + x[last]) / 2, low, high)
