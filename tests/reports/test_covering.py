from __future__ import annotations

import numpy as np

from reports.figure import Figure, Level, Trace
from reports.labels import Label
from reports.plotly_figure import plotly_figure
from reports.stretch import STRETCHES, outlines
from reports.svg_figure import svg_figure

TIME = np.arange(20_000) / 1000.0


def figure(*frequencies_hz: float, levels: tuple[Level, ...] = ()) -> Figure:
    traces = tuple(
        Trace(Label(f"{f:g} Hz"), TIME, np.sin(2 * np.pi * f * TIME), role)
        for f, role in zip(frequencies_hz, ("gain", "phase"), strict=False)
    )
    return Figure("f", Label("Torque"), "Time", "s", Label("Torque"), "N m", traces, levels=levels)


def test_curves_that_cover_each_other_are_shown_as_envelopes() -> None:
    found = outlines(figure(10.0, 12.0))
    assert list(found) == [0, 1]
    assert len(found[0].x) == STRETCHES
    assert found[0].high.min() > 0.95
    assert found[0].low.max() < -0.95


def test_slow_and_single_curves_stay_curves() -> None:
    assert outlines(figure(0.2, 0.3)) == {}
    assert outlines(figure(10.0)) == {}
    assert outlines(figure(10.0, 0.2)) == {}


def test_a_page_shows_the_curves_once_it_is_zoomed_in() -> None:
    drawn = plotly_figure(figure(10.0, 12.0))
    assert [trace["visible"] for trace in drawn["data"][:2]] == [False, False]
    assert [trace.get("fill") for trace in drawn["data"][2:]] == [None, "tonexty"] * 2
    assert drawn["covering"]["envelopes"] == [2, 3, 4, 5]
    assert drawn["layout"]["xaxis"]["range"] == [TIME[0], TIME[-1]]
    assert 3.0 < drawn["covering"]["curves_below"] < 5.0
    assert plotly_figure(figure(0.2, 0.3))["covering"] is None
    assert svg_figure(figure(10.0, 12.0)) != svg_figure(figure(0.2, 0.3))


def test_labels_of_levels_have_room_and_do_not_meet() -> None:
    close = figure(1.0, levels=(Level(2.0, "Limit 2 N m, gain"), Level(1.95, "Limit 1.95 N m, phase")))
    low, high = close.shown_y or (0.0, 0.0)
    assert low < -1.0
    assert high > 2.1
    assert [close.label_above(level) for level in close.levels] == [True, False]
    anchors = [note["yanchor"] for note in plotly_figure(close)["layout"]["annotations"]]
    assert anchors == ["bottom", "top"]
