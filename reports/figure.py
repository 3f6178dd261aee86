"""What a figure shows, in words and numbers; how it is drawn on screen or on paper is reported elsewhere."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from reports import labels
from reports.labels import Label

Array = npt.NDArray[np.float64]
Range = tuple[float, float]

_ROOM = 0.1  # of the height of the axes: a label of a level


@dataclass(frozen=True)
class Trace:
    """One line: `x`, `y` are 1-D of one length; NaN in `y` is a gap. `role` names a tone of the style.

    `points` draws samples instead of a line; `spread` is the lower and the upper edge of a shade around it.
    `width` is how many times as wide as usual it is, or how much larger its points: a wide line shows beside
    a thin one that lies on it.
    """

    label: Label
    x: Array
    y: Array
    role: str
    dash: str = "solid"
    width: float = 1.0
    points: bool = False
    spread: tuple[Array, Array] | None = None


@dataclass(frozen=True)
class Band:
    """A shaded stretch of the x axis with its label at the top; '' for none."""

    start: float
    end: float
    label: str


@dataclass(frozen=True)
class Level:
    """A horizontal line, such as a limit."""

    value: float
    label: str
    role: str = "limit"


@dataclass(frozen=True)
class Mark:
    """A point that matters, such as a peak."""

    x: float
    y: float
    label: str
    role: str


@dataclass(frozen=True)
class Figure:
    """One pair of axes. Ranges of None are chosen from the data; `logarithmic` are both axes, or x alone."""

    id: str
    title: Label
    x_text: str
    x_unit: str
    y_label: Label
    y_unit: str
    traces: tuple[Trace, ...]
    bands: tuple[Band, ...] = ()
    levels: tuple[Level, ...] = ()
    marks: tuple[Mark, ...] = ()
    x_range: Range | None = None
    y_range: Range | None = None
    logarithmic: bool = False
    logarithmic_x: bool = False
    caption: str = ""
    wide: bool = False

    @property
    def x_title(self) -> str:
        """Axis title with unit."""
        return f"{self.x_text} ({labels.unit(self.x_unit)})" if self.x_unit else self.x_text

    @property
    def y_title(self) -> Label:
        """Axis title with unit."""
        tail = f" ({labels.unit(self.y_unit)})" if self.y_unit else ""
        return Label(self.y_label.text, self.y_label.symbol, self.y_label.tail + tail)

    @property
    def shown_y(self) -> Range | None:
        """The range of y; with levels and none given, so wide that lines and labels of levels have room."""
        if self.y_range is not None or not self.levels or self.logarithmic:
            return self.y_range
        shown = [shown for trace in self.traces if (shown := self._visible(trace)).size]
        values = [level.value for level in self.levels]
        low = min([*values, *(float(y.min()) for y in shown)])
        high = max([*values, *(float(y.max()) for y in shown)])
        room = _ROOM * (high - low or 1.0)
        return low - 0.5 * room, high + room

    def label_above(self, level: Level) -> bool:
        """Whether a level's label has room above its line, beside the next level."""
        shown = self.shown_y
        if shown is None:
            return True
        above = [one.value for one in self.levels if one.value > level.value]
        return min([*above, shown[1]]) - level.value > 0.7 * _ROOM * (shown[1] - shown[0])

    def alternative_text(self) -> str:
        """What a reader who cannot see the figure should know."""
        parts = [f"Line chart: {self.title.plain()} over {self.x_text.lower()}."]
        for trace in self.traces:
            shown = self._visible(trace)
            if shown.size:
                low = labels.quantity(float(shown.min()), self.y_unit)
                high = labels.quantity(float(shown.max()), self.y_unit)
                parts.append(f"{trace.label.plain()}: from {low} to {high}.")
            else:
                parts.append(f"{trace.label.plain()}: no values.")
        parts += [f"{level.label} at {labels.quantity(level.value, self.y_unit)}." for level in self.levels]
        parts += [f"{mark.label}." for mark in self.marks]
        return " ".join(parts)

    def _visible(self, trace: Trace) -> Array:
        finite = np.isfinite(trace.y)
        if self.x_range is not None:
            finite &= (trace.x >= self.x_range[0]) & (trace.x <= self.x_range[1])
        return trace.y[finite]


@dataclass(frozen=True)
class Section:
    """Figures under one heading; `notes` say which figures could not be drawn, and why."""

    id: str
    title: str
    text: str
    figures: tuple[Figure, ...]
    notes: tuple[str, ...] = ()


def not_drawn(labels: Iterable[Label]) -> tuple[str, ...]:
    """The note of a section about what it lacks; empty if it lacks nothing."""
    names = ", ".join(dict.fromkeys(label.plain() for label in labels))
    return (f"Not drawn for want of values: {names}.",) if names else ()
