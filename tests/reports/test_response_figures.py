from __future__ import annotations

import numpy as np
import pytest

from hil.analysis.frequency_response import FrequencyResponse
from hil.core.channels import OUTPUTS
from reports.figure import Figure
from reports.parts import Page, Part, Table, page_html, page_pdf
from reports.plotly_figure import plotly_figure
from reports.response_figures import ModelResponse, gain_figure, phase_figure, residual_figure
from reports.svg_figure import svg_figure
from tests.hil.analysis import paper_plant
from tests.hil.analysis.conftest import GRID, paper_frf, paper_model, paper_recording

__all__ = ["paper_frf", "paper_model", "paper_recording"]


@pytest.fixture(scope="module")
def model() -> ModelResponse:
    return ModelResponse("order 5", GRID, {o: paper_plant.response(o, GRID) for o in OUTPUTS})


@pytest.fixture(scope="module")
def gain(paper_frf: FrequencyResponse, model: ModelResponse) -> Figure:
    return gain_figure(paper_frf, OUTPUTS[1], (model,))


def test_measured_points_lie_above_the_models_with_their_band(gain: Figure) -> None:
    curve, measured = gain.traces
    assert (curve.points, measured.points) == (False, True)
    assert measured.spread is not None
    low, high = measured.spread
    assert np.all(low <= measured.y)
    assert np.all(measured.y <= high)
    along = np.interp(measured.x, curve.x, curve.y)
    assert np.median(np.abs(measured.y - along)) < 1.0  # dB


def test_measured_phase_follows_the_model(paper_frf: FrequencyResponse, model: ModelResponse) -> None:
    curve, measured = phase_figure(paper_frf, OUTPUTS[1], (model,)).traces
    assert np.max(np.abs(measured.y - np.interp(measured.x, curve.x, curve.y))) < 60


def test_residuals_are_in_percent_beside_the_noise(paper_frf: FrequencyResponse) -> None:
    doubled = ModelResponse(
        "half", GRID, {o: np.multiply(0.5 + 0j, paper_plant.response(o, GRID)) for o in OUTPUTS}
    )
    left, noise = residual_figure(paper_frf, OUTPUTS[0], (doubled,)).traces
    assert np.median(left.y) == pytest.approx(100.0, rel=0.05)
    assert np.median(noise.y) < 10.0


def test_the_frequency_axis_is_logarithmic_on_screen_and_paper(gain: Figure) -> None:
    drawn = plotly_figure(gain)
    assert drawn["layout"]["xaxis"]["type"] == "log"
    assert "type" not in drawn["layout"]["yaxis"]
    (note,) = drawn["layout"]["annotations"]
    assert note["x"] == pytest.approx(np.log10(np.sqrt(8.0 * 20.0)))
    assert [trace["mode"] for trace in drawn["data"][:2]] == ["lines", "markers"]
    assert svg_figure(gain).startswith(b"<?xml")


def test_a_page_of_parts_has_its_figures_interactive_and_the_first_part_on_top(gain: Figure) -> None:
    table = Table(("criterion", "value", "limit"), (("misfit", "1 %", "5 %"),))
    first = Part("quality", "Quality", "", (table,), figures=(gain,))
    page = Page("Kind", "t", "Linear", "pass", "lead", (), (Part("more", "More", "text"),), first=first)
    html = page_html(page)
    assert html.index("Linear</h2>") < html.index('id="quality"') < html.index('id="more"')
    assert 'class="plot" id="figure-1"' in html
    assert '"figure-1":' in html
    assert page_pdf(page).startswith(b"%PDF")
    plain = page_html(Page("Kind", "t", "Linear", "pass", "lead", (), (Part("more", "More", "text"),)))
    assert len(plain) < 50_000
