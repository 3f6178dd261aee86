"""One picture of a diagnosis for who does not read tables: how far simulation and measurement are apart.

Two bars a channel, in per cent of the signal: the model as it came, and the one given back. A line across
them says what noise alone makes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from reports import quantities, style
from reports.labels import Label
from reports.svg_canvas import svg_canvas

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_LEFT_MM, _RIGHT_MM, _BOTTOM_MM, _TOP_MM = 30.0, 14.0, 8.5, 5.0
_NARROW_LEFT_MM = 18.0
_ROW_MM, _BAR = 9.0, 0.36
_ROLES = {"before": "phase", "after": "gain"}


@dataclass(frozen=True)
class GapRow:
    """A channel: its name, and gaps and noise in per cent of the signal's rms."""

    name: str
    before: float
    after: float
    noise: float


@dataclass(frozen=True)
class GapBars:
    """Bars of all channels; `rows` from the top."""

    id: str
    title: Label
    rows: tuple[GapRow, ...]
    caption: str = ""
    wide: bool = True

    def alternative_text(self) -> str:
        """The picture in words."""
        lines = [
            f"{r.name}: before {_percent(r.before)}, after {_percent(r.after)}, noise {_percent(r.noise)}"
            for r in self.rows
        ]
        return f"{self.title.plain()}. " + "; ".join(lines) + "."

    def as_svg(self) -> bytes:
        """The picture in the house style for paper, a whole text line wide or half of one."""
        width = style.PAPER_WIDE_MM[0] if self.wide else style.PAPER_WIDTH_MM
        left = _LEFT_MM if self.wide else _NARROW_LEFT_MM
        height = _BOTTOM_MM + _TOP_MM + _ROW_MM * max(1, len(self.rows))
        with svg_canvas(width, height) as picture:
            canvas = picture.canvas
            box = (
                left / width,
                _BOTTOM_MM / height,
                1 - (left + _RIGHT_MM) / width,
                1 - (_BOTTOM_MM + _TOP_MM) / height,
            )
            axes = canvas.add_axes(box)
            self._draw(axes)
            canvas.legend(
                loc="upper left",
                bbox_to_anchor=(left / width if self.wide else 0.0, 1.0),
                ncols=3,
                borderaxespad=0.2,
                borderpad=0.1,
                handlelength=1.8,
            )
        return picture.svg

    def _draw(self, axes: Axes) -> None:
        for index, row in enumerate(self.rows):
            for turn, when in enumerate(("before", "after")):
                size, at = getattr(row, when), index + (turn - 0.5) * _BAR
                color = style.SERIES[_ROLES[when]].light
                axes.barh(at, size, _BAR, color=color, label=f"model {when}" if index == 0 else None)
                axes.annotate(
                    _percent(size), (size, at), (2, 0),
                    textcoords="offset points", va="center",
                )  # fmt: skip
            axes.plot(
                [row.noise, row.noise],
                [index - 1.25 * _BAR, index + 1.25 * _BAR],
                "--",
                color=style.SERIES["limit"].light,
                label="noise alone" if index == 0 else None,
            )
        axes.set_yticks(range(len(self.rows)), [row.name for row in self.rows])
        axes.set_ylim(len(self.rows) - 0.5, -0.5)
        axes.grid(visible=False, axis="y")
        axes.set_xlim(0.0, max((max(r.before, r.after, r.noise) for r in self.rows), default=1.0) or 1.0)
        axes.set_xlabel("measured minus simulated, % of the signal (rms)", labelpad=2)


def _percent(value: float) -> str:
    """As the tables of a diagnosis have it."""
    return quantities.share(value / 100.0, 2, digits=3)
