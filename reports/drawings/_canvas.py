"""A canvas in the house style: units on every axis, comfort band and resonance marked."""

from __future__ import annotations

import io
from dataclasses import dataclass

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from hil.core.channels import COMFORT_BAND_HZ
from reports import style
from reports.labels import Label

BLUE, VERMILLION, GREEN, PURPLE = (style.SERIES[r].light for r in ("gain", "phase", "third", "fourth"))
ORANGE, GREY = style.SERIES["fifth"].light, style.SERIES["reference"].light
SKY = style.SERIES["gain"].dark  # what was measured, under lines of the same quantity
BLACK, BAND = style.SURFACE["ink"].light, style.SURFACE["band"].light

_DPI = 150
_FONT = 9.0


def new_figure(width_cm: float = 16.0, height_cm: float = 11.0) -> Figure:
    """An empty figure with constrained layout and an Agg canvas; no state outside of it."""
    figure = Figure(figsize=(width_cm / 2.54, height_cm / 2.54), layout="constrained", dpi=_DPI)
    FigureCanvasAgg(figure)
    return figure


def style_axes(axes: Axes) -> None:
    """Light grid behind the data, no box, small type."""
    axes.grid(True, which="major", color=style.SURFACE["rule"].light, linewidth=0.6)
    axes.grid(True, which="minor", color=style.SURFACE["grid"].light, linewidth=0.4)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=_FONT, which="both")
    for label in (axes.xaxis.label, axes.yaxis.label):
        label.set_fontsize(_FONT + 0.5)
    axes.title.set_fontsize(_FONT + 1.5)


def frequency_axis(axes: Axes, low_hz: float, high_hz: float, *, label: bool = True) -> None:
    """Logarithmic frequency with plain numbers (0.1, 1, 10) and the unit."""
    axes.set_xscale("log")
    axes.set_xlim(low_hz, high_hz)
    axes.xaxis.set_major_locator(LogLocator(base=10, subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())
    if label:
        axes.set_xlabel("Frequency in Hz")


def mark_band(axes: Axes, resonance_hz: float | None, *, named: bool = True) -> None:
    """Shade 8-20 Hz and mark the resonance."""
    axes.axvspan(*COMFORT_BAND_HZ, color=BAND, zorder=0, linewidth=0, label="8-20 Hz" if named else None)
    if resonance_hz is not None:
        label = f"resonance {resonance_hz:.1f} Hz" if named else None
        axes.axvline(resonance_hz, color=GREY, linewidth=0.9, linestyle=(0, (4, 2)), zorder=1, label=label)


def legend(axes: Axes, **options: object) -> None:
    """A legend without a box."""
    axes.legend(**({"fontsize": _FONT - 1, "frameon": False, "handlelength": 1.8} | options))  # type: ignore[arg-type]


def symbol(text: str) -> str:
    """A channel's symbol as mathematics: 'T_m*' becomes T with subscript m and an asterisk."""
    base, _, index = text.partition("_")
    star = "^*" if index.endswith("*") else ""
    letters = {"ω": r"\omega"}
    return f"${letters.get(base, base)}_{{{index.rstrip('*')}}}{star}$"


def render(figure: Figure) -> dict[str, bytes]:
    """The figure as 'png' and 'svg'; the same figure always gives the same bytes."""
    pictures = {}
    figure.draw_without_rendering()
    figure.set_layout_engine("none")  # laid out once, for both
    for kind, metadata in (("png", {"Software": None}), ("svg", {"Date": None, "Creator": None})):
        buffer = io.BytesIO()
        with mpl.rc_context({"svg.hashsalt": "hil"}):
            figure.savefig(buffer, format=kind, dpi=_DPI, metadata=metadata)  # type: ignore[arg-type]
        pictures[kind] = buffer.getvalue()
    return pictures


@dataclass(frozen=True)
class Drawing:
    """An SVG with its title and its words for who cannot see it."""

    title: Label
    svg: bytes
    words: str
    caption: str = ""
    wide: bool = True

    def as_svg(self) -> bytes:
        """The picture."""
        return self.svg

    def alternative_text(self) -> str:
        """What it shows, in words."""
        return self.words
