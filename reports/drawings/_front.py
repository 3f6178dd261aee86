"""What can be traded for what: figures of merit of many candidates, those that none beats, named ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from reports.drawings import _canvas as style
from reports.front_figures import within_sight

Array = npt.NDArray[np.float64]

_MARKS = ("*", "o", "D", "s", "^")
_COLOURS = (style.BLUE, style.VERMILLION, style.GREEN, style.PURPLE, style.ORANGE)  # as in the responses


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
