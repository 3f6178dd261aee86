"""Figures on paper: whatever a run has of lines, there is room for them."""

import numpy as np
import pytest

from reports.figure import Figure, Trace
from reports.labels import Label
from reports.svg_figure import svg_figure


def of_lines(count: int, wide: bool) -> str:
    time = np.linspace(0.0, 1.0, 50)
    lines = tuple(Trace(Label(f"line {k + 1}"), time, time * k, "gain") for k in range(count))
    title, torque = Label("Many lines"), Label("Shaft torque")
    figure = Figure("many", title, "Time", "s", torque, "N m", lines, wide=wide)
    return svg_figure(figure).decode()


@pytest.mark.parametrize("wide", [False, True])
def test_more_lines_than_a_legend_has_room_for_are_counted(wide: bool) -> None:
    most = 18 if wide else 6
    assert "more" not in of_lines(most, wide)
    told = of_lines(60, wide)
    assert f"and {60 - most + 1} more" in told
    assert f"<!-- line {most - 1} -->" in told
    assert f"<!-- line {most} -->" not in told


def test_one_line_needs_no_legend() -> None:
    assert "<!-- line 1 -->" not in of_lines(1, False)
