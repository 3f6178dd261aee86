"""A figure as the JSON that plotly.js draws; colours are left to the page, which knows light from dark."""

from __future__ import annotations

import base64
import html
import json
import math
import re
from importlib import resources
from typing import Any

import numpy as np
import numpy.typing as npt

from reports import labels, style
from reports.figure import Band, Figure, Mark, Trace
from reports.stretch import Outline, envelope, outlines, shown_x

_CONTROL = re.compile(r"[\x00-\x08\x0b\x0e-\x1f\x7f]")
#: Share of the axes' height over which the labels of bands alternate.
_BAND_LABEL_Y = 0.985
#: Share of the time axis below which curves are shown in place of envelopes.
_ZOOMED = 0.2


def plotly_figure(figure: Figure) -> dict[str, Any]:
    """`data` and `layout` for Plotly.newPlot; lines and shapes carry their role in `meta` or `name`."""
    shapes, annotations = _bands(figure)
    level_shapes, level_annotations = _levels(figure)
    covering = outlines(figure)
    lines = [{**_trace(t, figure), "visible": n not in covering} for n, t in enumerate(figure.traces)]
    spreads = [edge for trace in figure.traces for edge in _spread(trace, figure)]
    edges = [edge for n, found in covering.items() for edge in _edges(figure.traces[n], found, figure)]
    marks = list(map(_mark, figure.marks))
    return {
        "data": [*lines, *edges, *spreads, *marks],
        "covering": _covering(covering, len(lines), len(edges)),
        "layout": {
            "xaxis": _axis(
                figure.x_title, shown_x(figure, covering), figure.logarithmic or figure.logarithmic_x
            )
            | ({"dtick": "D2", "exponentformat": "none"} if figure.logarithmic_x else {}),
            "yaxis": _axis(figure.y_title.as_html(), figure.shown_y, figure.logarithmic),
            "shapes": shapes + level_shapes,
            "annotations": annotations + level_annotations,
            "showlegend": len(figure.traces) > 1,
        },
    }


def _trace(trace: Trace, figure: Figure) -> dict[str, Any]:
    x, y = trace.x, trace.y
    if not trace.points:
        x, y = envelope(x, y, style.POINTS_ON_SCREEN, logarithmic=figure.logarithmic)
    unit = html.escape(labels.unit(figure.y_unit))
    x_unit = html.escape(labels.unit(figure.x_unit))
    return {
        "type": "scatter",
        "mode": "markers" if trace.points else "lines",
        **({"marker": {"size": 4 * trace.width}} if trace.points else {}),
        "name": trace.label.as_html(),
        "meta": trace.role,
        "x": _packed(x),
        "y": _packed(y),
        "line": {
            "width": style.LINE_WIDTH_PX * style.WIDER.get(trace.role, 1.0) * trace.width,
            "dash": trace.dash,
        },
        "hovertemplate": f"%{{y:.4~g}}{labels.THIN}{unit} at %{{x:.4~g}}{labels.THIN}{x_unit}",
    }


def _spread(trace: Trace, figure: Figure) -> list[dict[str, Any]]:
    """The shade around a line, such as a band of confidence, as two edges without width."""
    if trace.spread is None:
        return []
    edge = _trace(trace, figure) | {"mode": "lines", "line": {"width": 0}, "showlegend": False}
    edge |= {"x": _packed(trace.x), "hoverinfo": "skip", "hovertemplate": None}
    low, high = ({"y": _packed(values)} for values in trace.spread)
    return [edge | low, edge | high | {"fill": "tonexty"}]


def _edges(trace: Trace, outline: Outline, figure: Figure) -> list[dict[str, Any]]:
    """The envelope of a curve: its lower edge, and its upper one with the shade between them."""
    whole = _trace(trace, figure) | {"x": _packed(outline.x), "legendgroup": trace.label.as_html()}
    whole["line"] = {"width": 1.0}
    unit = html.escape(labels.unit(figure.y_unit))
    words = f"%{{y:.4~g}}{labels.THIN}{unit}"
    low = {"y": _packed(outline.low), "showlegend": False, "hovertemplate": f"lowest {words}"}
    high = {"y": _packed(outline.high), "fill": "tonexty", "hovertemplate": f"highest {words}"}
    return [whole | low, whole | high]


def _covering(covering: dict[int, Outline], lines: int, edges: int) -> dict[str, Any] | None:
    """Numbers of the traces that are shown as envelopes, and as curves once the page is zoomed in."""
    if not covering:
        return None
    span = min(float(found.x[-1] - found.x[0]) for found in covering.values())
    return {
        "curves": list(covering),
        "envelopes": list(range(lines, lines + edges)),
        "curves_below": span * _ZOOMED,
    }


def _mark(mark: Mark) -> dict[str, Any]:
    return {
        "type": "scatter",
        "mode": "markers",
        "name": html.escape(mark.label),
        "meta": mark.role,
        "x": [mark.x],
        "y": [mark.y],
        "marker": {"size": 8, "symbol": "circle-open", "line": {"width": 2}},
        "hovertemplate": "%{fullData.name}<extra></extra>",
        "showlegend": False,
    }


def _packed(values: npt.NDArray[np.float64]) -> dict[str, str]:
    """Single precision, as plotly.js reads it: a third of the size of decimal digits."""
    return {"dtype": "f4", "bdata": base64.b64encode(values.astype("<f4").tobytes()).decode()}


def _axis(title: str, shown: tuple[float, float] | None, logarithmic: bool) -> dict[str, Any]:
    axis: dict[str, Any] = {"title": {"text": title}}
    if logarithmic:
        axis |= {"type": "log", "exponentformat": "power", "dtick": 1}
        shown = (math.log10(shown[0]), math.log10(shown[1])) if shown else None
    if shown:
        axis["range"] = list(shown)
    return axis


def _bands(figure: Figure) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    shapes = [
        {
            "type": "rect",
            "layer": "below",
            "xref": "x",
            "yref": "paper",
            "x0": band.start,
            "x1": band.end,
            "y0": 0,
            "y1": 1,
            "line": {"width": 0},
            "name": "band",
        }
        for band in figure.bands
    ]
    annotations = [
        _annotation(band.label, "quiet")
        | {
            "xref": "x",
            "yref": "paper",
            "x": _middle(band, figure),
            "y": _BAND_LABEL_Y,
            "yanchor": "top",
        }
        for band in figure.bands
        if band.label
    ]
    return shapes, annotations


def _middle(band: Band, figure: Figure) -> float:
    """Where a label stands; plotly.js counts annotations of a logarithmic axis in powers of ten."""
    if figure.logarithmic or figure.logarithmic_x:
        return 0.5 * (math.log10(band.start) + math.log10(band.end))
    return (band.start + band.end) / 2


def _levels(figure: Figure) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    shapes = [
        {
            "type": "line",
            "xref": "paper",
            "yref": "y",
            "x0": 0,
            "x1": 1,
            "y0": level.value,
            "y1": level.value,
            "line": {"width": 1.4, "dash": "dash"},
            "name": f"series-{level.role}",
        }
        for level in figure.levels
    ]
    sides = [(one, "bottom" if figure.label_above(one) else "top") for one in figure.levels]
    annotations = [
        _annotation(level.label, f"series-{level.role}")
        | {"xref": "paper", "yref": "y", "x": 1, "y": level.value, "xanchor": "right", "yanchor": side}
        for level, side in sides
    ]
    return shapes, annotations


def _annotation(text: str, tone: str) -> dict[str, Any]:
    return {"text": html.escape(text), "showarrow": False, "font": {"size": 11}, "name": tone}


def json_in_script(value: object) -> str:
    """JSON that cannot end the script element that it stands in."""
    text = json.dumps(value, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")


def plotly_script() -> str:
    """The library, without control characters: HTML forbids them, JavaScript reads them spelled out too."""
    script = resources.files("reports").joinpath("templates/plotly.min.js")  # a wheel has it
    if not script.is_file():
        script = resources.files("plotly").joinpath("package_data/plotly.min.js")
    text = script.read_text(encoding="utf-8")
    return _CONTROL.sub(lambda found: f"\\x{ord(found[0]):02x}", text)
