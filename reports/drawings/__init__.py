"""Figures in the house style, as SVG and PNG."""

from reports.drawings._bode import Curve, bode, coherence
from reports.drawings._canvas import Drawing, render
from reports.drawings._distribution import distribution, front
from reports.drawings._loops import Loops, nyquist, sensitivity, trade_off_chart

__all__ = [
    "Curve",
    "Drawing",
    "Loops",
    "bode",
    "coherence",
    "distribution",
    "front",
    "nyquist",
    "render",
    "sensitivity",
    "trade_off_chart",
]
