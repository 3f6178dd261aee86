"""A figure on paper: SVG by Matplotlib in the house style, without its global state."""

from __future__ import annotations

import io
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from reports import style
from reports.figure import Figure
from reports.labels import Label
from reports.stretch import Outline, envelope, outlines, shown_x

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Canvas
    from matplotlib.lines import Line2D

MM_PER_INCH = 25.4


@dataclass
class Picture:
    """A canvas to draw on, and once that is done its SVG."""

    canvas: Canvas
    svg: bytes = b""


@contextmanager
def svg_canvas(width_mm: float, height_mm: float) -> Iterator[Picture]:
    """A canvas of a size; what is drawn on it within the block is the picture's SVG after it."""
    import matplotlib as mpl  # slow to import; only paper needs it
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure as Canvas

    with mpl.rc_context(style.PAPER):
        canvas = Canvas(figsize=(width_mm / MM_PER_INCH, height_mm / MM_PER_INCH))
        FigureCanvasSVG(canvas)
        picture = Picture(canvas)
        yield picture
        picture.svg = _svg(canvas)


def _svg(canvas: Canvas) -> bytes:
    out = io.BytesIO()
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing from font")  # drawn as a box
        canvas.savefig(out, format="svg", metadata={"Date": None, "Creator": None})
    return out.getvalue()


_LEFT_MM, _RIGHT_MM, _BOTTOM_MM, _TOP_MM = 14.5, 3.5, 8.5, 1.5
_LEGEND_ROW_MM = 3.4
_MOST_LEGEND_ROWS = 6
_PLATE = {"facecolor": "white", "alpha": 0.85, "linewidth": 0, "pad": 0.6}  # no line strikes a label through
_POINT = 1.6  # size of a sample
_CLEAR_PT = 1.6  # between a level and its label
_DASHES = {"solid": "-", "dash": "--", "dot": ":", "dashdot": "-."}


def svg_figure(figure: Figure) -> bytes:
    """The figure in the house style for paper, half a text line wide, or a whole one if it is `wide`."""
    narrow = (style.PAPER_WIDTH_MM, style.PAPER_HEIGHT_MM)
    width, height = style.PAPER_WIDE_MM if figure.wide else narrow
    columns = 3 if figure.wide else 1
    named = _named(figure, _MOST_LEGEND_ROWS * columns)
    top = _TOP_MM + _LEGEND_ROW_MM * -(-len(named) // columns)
    with svg_canvas(width, height) as picture:
        canvas = picture.canvas
        box = (_LEFT_MM / width, _BOTTOM_MM / height, _axes_width_mm(figure) / width)
        axes = canvas.add_axes((*box, 1 - (_BOTTOM_MM + top) / height))
        lines = _draw(axes, figure)
        if named:
            canvas.legend(
                handles=_handles(lines, named),
                labels=named,
                loc="upper left",
                bbox_to_anchor=(_LEFT_MM / width, 1.0),
                ncols=columns,
                borderaxespad=0.2,
                borderpad=0.1,
                labelspacing=0.25,
                handlelength=1.8,
            )
    return picture.svg


def _named(figure: Figure, most: int) -> list[str]:
    """What the legend says: of one line nothing, of more than `most` how many more there are."""
    names = [trace.label.as_mathtext() for trace in figure.traces]
    if len(names) <= most:
        return names if len(names) > 1 else []
    return [*names[: most - 1], f"and {len(names) - most + 1} more"]


def _handles(lines: list[Line2D], named: list[str]) -> list[Line2D]:
    """What stands before each name: the lines, and nothing before how many more there are."""
    if len(lines) <= len(named):
        return lines
    from matplotlib.lines import Line2D

    return [*lines[: len(named) - 1], Line2D([], [], alpha=0.0)]


def _axes_width_mm(figure: Figure) -> float:
    width = style.PAPER_WIDE_MM[0] if figure.wide else style.PAPER_WIDTH_MM
    return width - _LEFT_MM - _RIGHT_MM


def _draw(axes: Axes, figure: Figure) -> list[Line2D]:
    lines = []
    covering = outlines(figure)
    for number, trace in enumerate(figure.traces):
        if number in covering:
            lines.append(_outlined(axes, covering[number], style.SERIES[trace.role].light))
            continue
        if trace.spread is not None:
            tone = style.SERIES[trace.role].light
            axes.fill_between(trace.x, *trace.spread, color=tone, alpha=0.25, linewidth=0)
        if trace.points:
            tone = style.SERIES[trace.role].light
            size = _POINT * trace.width
            lines += axes.plot(
                trace.x, trace.y, "o", color=tone, markersize=size, markeredgewidth=0, zorder=4
            )
            continue
        points = style.POINTS_ON_PAPER * (2 if figure.wide else 1)
        x, y = envelope(trace.x, trace.y, points, logarithmic=figure.logarithmic)
        color = style.SERIES[trace.role].light
        (drawn,) = axes.plot(x, y, _DASHES[trace.dash], color=color)
        drawn.set_linewidth(drawn.get_linewidth() * style.WIDER.get(trace.role, 1.0) * trace.width)
        lines.append(drawn)
    if figure.logarithmic:
        axes.set_xscale("log")
        axes.set_yscale("log")
    elif figure.logarithmic_x:
        _plain_decades(axes)
    axes.margins(x=0)
    if (shown := shown_x(figure, covering)) is not None:
        axes.set_xlim(shown)
    if figure.shown_y:
        axes.set_ylim(figure.shown_y)
    axes.set_xlabel(Label(figure.x_title).as_mathtext(), labelpad=2)
    axes.set_ylabel(figure.y_title.as_mathtext(), va="top")
    axes.yaxis.set_label_coords(-(_LEFT_MM - 0.5) / _axes_width_mm(figure), 0.5)  # one edge for all figures
    _mark(axes, figure)
    return lines


def _plain_decades(axes: Axes) -> None:
    """A logarithmic x axis whose numbers are written out: 0.1, 1, 10."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axes.set_xscale("log")
    axes.xaxis.set_major_locator(LogLocator(base=10, subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())


def _outlined(axes: Axes, outline: Outline, color: str) -> Line2D:
    """The envelope of a curve, both edges and a light shade between them."""
    axes.fill_between(outline.x, outline.low, outline.high, color=color, alpha=0.25, linewidth=0)
    axes.plot(outline.x, outline.low, color=color, linewidth=0.6)
    (upper,) = axes.plot(outline.x, outline.high, color=color, linewidth=0.6)
    return upper


def _mark(axes: Axes, figure: Figure) -> None:
    ink, band_colour = style.SURFACE["quiet"].light, style.SURFACE["band"].light
    for band in figure.bands:
        axes.axvspan(band.start, band.end, color=band_colour, linewidth=0, zorder=0)
        if not band.label:
            continue
        axes.text(
            (band.start * band.end) ** 0.5 if figure.logarithmic_x else (band.start + band.end) / 2,
            0.985,
            Label(band.label).as_mathtext(),
            transform=axes.get_xaxis_transform(),
            ha="center",
            va="top",
            color=ink,
            clip_on=True,
            bbox=_PLATE | {"facecolor": band_colour},
            zorder=6,
        )
    for mark in figure.marks:
        color = style.SERIES[mark.role].light
        axes.plot([mark.x], [mark.y], "o", markersize=3.2, markerfacecolor="white", color=color, zorder=5)
    for level in figure.levels:
        color = style.SERIES[level.role].light
        axes.axhline(level.value, color=color, linewidth=0.8, linestyle="--")
        above = figure.label_above(level)
        axes.annotate(
            Label(level.label).as_mathtext(),
            (0.995, level.value),
            xycoords=axes.get_yaxis_transform(),
            xytext=(0, _CLEAR_PT if above else -_CLEAR_PT),
            textcoords="offset points",
            ha="right",
            va="bottom" if above else "top",
            color=color,
            bbox=_PLATE,
            zorder=6,
        )
    low, high = axes.get_ylim()
    if not (np.isfinite(low) and np.isfinite(high)):
        axes.set_ylim(0, 1)
