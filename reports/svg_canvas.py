"""Matplotlib's canvas in the house style for paper, without its global state, and the SVG from it."""

from __future__ import annotations

import io
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

from reports import style

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

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
