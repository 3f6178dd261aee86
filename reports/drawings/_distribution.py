"""How often which value came: one criterion over many simulations, beside its limits."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from reports.drawings import _canvas as style

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
