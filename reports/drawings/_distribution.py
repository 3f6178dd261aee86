"""Many simulations or candidates at once: how often which value came, and what can be traded for what."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from reports.drawings import _canvas as style
from reports.front_figures import within_sight

Array = npt.NDArray[np.float64]

_COLOURS = (style.BLUE, style.VERMILLION, style.GREEN, style.PURPLE, style.ORANGE)
_FEWEST_BINS, _MOST_BINS = 5, 40
_MOST_TICKS = 6


def distribution(label: str, values: Mapping[str, Array], limits: tuple[float, ...]) -> Figure:
    """Shares of simulations by value, each controller over the same bins.

    Args:
        label: of the value, with its unit.
        values: finite, by name of the controller; what is empty is left out.
        limits: drawn as lines; one that would flatten the values is named at the edge.
    """
    figure = style.new_figure(11, 6)
    axes = figure.subplots()
    there = {name: found for name, found in values.items() if found.size}
    edges = _edges(np.concatenate(list(there.values())), limits)
    for (name, found), colour in zip(there.items(), _COLOURS * len(there), strict=False):
        counts, _ = np.histogram(found, edges)
        axes.stairs(100 * counts / found.size, edges, color=colour, fill=True, alpha=0.25)
        axes.stairs(100 * counts / found.size, edges, color=colour, linewidth=1.2, label=name or None)
    low, high = edges[0], edges[-1]
    for limit in limits:
        if low - (high - low) < limit < high + (high - low):
            axes.axvline(
                limit, color=style.BLACK, linewidth=1.1, linestyle=(0, (5, 2)), label=f"limit {limit:g}"
            )
        else:  # within the axes at the edge that is nearer to it, where nothing cuts it off
            beyond = limit > high
            place, words = ((0.99, f"limit {limit:g} →"), (0.01, f"← limit {limit:g}"))[not beyond]
            side = "right" if beyond else "left"
            axes.text(place, 0.97, words, ha=side, va="top", fontsize=8, transform=axes.transAxes)
    if low >= 0.0:
        axes.set_xlim(left=max(0.0, axes.get_xlim()[0]))
    axes.xaxis.set_major_locator(MaxNLocator(_MOST_TICKS))
    axes.set_xlabel(label)
    axes.set_ylabel("Simulations in %")
    axes.set_ylim(bottom=0)
    style.style_axes(axes)
    if axes.get_legend_handles_labels()[1]:
        figure.legend(loc="outside lower center", ncols=3, frameon=False, fontsize=8)
    return figure


def _edges(values: Array, limits: tuple[float, ...]) -> Array:
    """Bins of one width, as many as the number of values bears; a limit near by is an edge."""
    low, high = float(values.min()), float(values.max())
    if high - low <= 1e-9 * max(abs(low), abs(high), 1e-300):
        room = 0.01 * max(abs(low), 1e-9)
        least = max(low - room, 0.0) if low >= 0.0 else low - room
        return np.linspace(least, high + room, 4)
    bins = int(np.clip(np.sqrt(values.size), _FEWEST_BINS, _MOST_BINS))
    width = (high - low) / bins
    inside = [limit for limit in limits if low < limit < high]
    below = np.ceil((inside[0] - low) / width) if inside else 0.0
    start = inside[0] - below * width if inside else low
    if start < 0.0 <= low:  # an energy is never negative, and neither is a bin of it
        start, width = 0.0, inside[0] / below
    return np.asarray(start + width * np.arange(np.ceil((high - start) / width - 1e-9) + 1))


_MARKS = ("*", "o", "D", "s", "^")


def front(
    labels: tuple[str, str, str], every: Array, best: Array, named: Mapping[str, Sequence[float]]
) -> Figure:
    """The second and the third figure over the first.

    Args:
        labels: of the three figures, with units.
        every: N x 3, candidates within the hard limits.
        best: M x 3, those of them that no other beats in all three.
        named: controllers that are marked.
    """
    figure = style.new_figure(22, 10.5)
    panels = figure.subplots(1, 2)
    near = best[within_sight(best, list(named.values()))]
    for axes, column in zip(panels, (1, 2), strict=True):
        axes.plot(every[:, 0], every[:, column], ".", color=style.GREY, markersize=3, alpha=0.35)
        axes.plot(
            best[:, 0],
            best[:, column],
            ".",
            color=style.SKY,
            markersize=7,
            label="none is better in all three",
        )
        for (name, point), mark, colour in zip(named.items(), _MARKS, _COLOURS, strict=False):
            size = 14 if mark == "*" else 7
            axes.plot(
                point[0],
                point[column],
                marker=mark,
                markersize=size,
                color=colour,
                linestyle="none",
                label=name,
            )
        axes.set_xlabel(labels[0])
        axes.set_ylabel(labels[column])
        _zoom(axes, near[:, [0, column]], [[point[0], point[column]] for point in named.values()])
        style.style_axes(axes)
    handles, names = panels[0].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside lower center", ncols=5, frameon=False, fontsize=8.5)
    return figure


def _zoom(axes: Axes, best: Array, named: list[list[float]]) -> None:
    """Show the front and what is named; far candidates would flatten both."""
    shown = np.vstack([best, np.array(named).reshape(-1, 2)])
    low, high = shown.min(axis=0), shown.max(axis=0)
    room = 0.08 * np.maximum(high - low, 1e-3 * np.maximum(np.abs(high), 1e-12))
    axes.set_xlim(low[0] - room[0], high[0] + room[0])
    axes.set_ylim(low[1] - room[1], high[1] + room[1])
