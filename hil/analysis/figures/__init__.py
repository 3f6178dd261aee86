"""Figures in the house style, as SVG and PNG."""

from hil.analysis.figures._bode import Curve, bode, coherence
from hil.analysis.figures._loops import Loops, nyquist, sensitivity, trade_off_chart
from hil.analysis.figures._style import render

__all__ = ["Curve", "Loops", "bode", "coherence", "nyquist", "render", "sensitivity", "trade_off_chart"]
