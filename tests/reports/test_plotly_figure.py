from __future__ import annotations

import base64
import json
from typing import Any

import numpy as np
import plotly.graph_objects as go
import pytest

from hil.core.recording import Recording
from hil.core.result import RunResult
from reports import style
from reports.figure import Figure
from reports.plotly_figure import plotly_figure
from reports.sections import sections


def all_figures(recording: Recording, result: RunResult | None) -> list[Figure]:
    return [figure for section in sections(recording, result) for figure in section.figures]


def numbers(packed: dict[str, str]) -> np.ndarray:
    return np.frombuffer(base64.b64decode(packed["bdata"]), "<f4")


@pytest.mark.parametrize("judged", [True, False])
def test_plotly_accepts_every_figure(recording: Recording, result: RunResult, judged: bool) -> None:
    for figure in all_figures(recording, result if judged else None):
        drawn: dict[str, Any] = json.loads(json.dumps(plotly_figure(figure), allow_nan=False))
        assert go.Figure(drawn).data


def test_points_are_few_and_keep_the_peak(recording: Recording, result: RunResult) -> None:
    for figure in all_figures(recording, result):
        lines = plotly_figure(figure)["data"][: len(figure.traces)]  # marks follow them
        for trace, drawn in zip(figure.traces, lines, strict=True):
            y = numbers(drawn["y"])
            assert len(y) == len(numbers(drawn["x"])) <= style.POINTS_ON_SCREEN + 2
            assert y.max() == np.float32(np.nanmax(trace.y))


def test_colours_are_named_by_role(recording: Recording, result: RunResult) -> None:
    for figure in all_figures(recording, result):
        drawn = plotly_figure(figure)
        assert all(trace["meta"] in style.SERIES for trace in drawn["data"])
        assert "color" not in json.dumps([trace.get("line", trace.get("marker")) for trace in drawn["data"]])


def test_every_tone_is_readable_on_its_surface() -> None:
    for theme in ("light", "dark"):
        page = getattr(style.SURFACE["page"], theme)
        words = [style.SURFACE[name] for name in ("ink", "quiet", "link", "pass", "fail", "error")]
        assert all(contrast(getattr(tone, theme), page) >= 4.5 for tone in words)
        assert all(contrast(getattr(tone, theme), page) >= 3.0 for tone in style.SERIES.values())


def contrast(one: str, other: str) -> float:
    """Ratio of luminances as WCAG 2 defines it."""

    def luminance(colour: str) -> float:
        channels = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255
        linear = np.where(channels <= 0.04045, channels / 12.92, ((channels + 0.055) / 1.055) ** 2.4)
        return float(linear @ [0.2126, 0.7152, 0.0722])

    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)
