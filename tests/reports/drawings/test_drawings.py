from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure

from hil.analysis.control_design import DesignSpec, design
from hil.analysis.frequency_response import FrequencyResponse
from hil.core.channels import OUTPUTS
from hil.core.model import Model
from reports import drawings as figures
from tests.hil.analysis import paper_plant
from tests.hil.analysis.conftest import GRID


@pytest.fixture(scope="module")
def drawn(paper_model: Model, paper_frf: FrequencyResponse) -> dict[str, Figure]:
    found = design(paper_model, DesignSpec())
    loops = {loop.name: loop.sampled for loop in found.loops}
    curve = figures.Curve("model", GRID, paper_plant.response(OUTPUTS[1], GRID))
    return {
        "bode": figures.bode(paper_frf, OUTPUTS[1], (curve,), resonance_hz=10.6),
        "coherence": figures.coherence(paper_frf),
        "nyquist": figures.nyquist(found.frequency_hz, loops, 10.6),
        "sensitivity": figures.sensitivity(found.frequency_hz, loops, 10.6),
        "trade_off": figures.trade_off_chart(found.trade_off, chosen=(-20.0, 1.4)),
    }


@pytest.mark.parametrize("name", ["bode", "coherence", "sensitivity"])
def test_frequency_axes_are_logarithmic_and_marked(drawn: dict[str, Figure], name: str) -> None:
    axes = drawn[name].axes
    assert all(a.get_xscale() == "log" for a in axes)
    assert axes[-1].get_xlabel() == "Frequency in Hz"
    for one in axes:
        assert one.patches, "the comfort band is shaded"
        assert one.get_ylabel()


def test_bode_names_quantity_and_unit(drawn: dict[str, Figure]) -> None:
    gain, phase = drawn["bode"].axes
    assert "1 rad/s per N m" in gain.get_ylabel()
    assert phase.get_ylabel() == "Phase in degrees"
    assert r"\omega_{l}" in gain.get_title(loc="left")


def test_measured_phase_follows_the_model(drawn: dict[str, Figure]) -> None:
    dots, curve = drawn["bode"].axes[1].get_lines()[1:3]
    along = np.interp(dots.get_xdata(), curve.get_xdata(), curve.get_ydata())  # type: ignore[arg-type]
    assert np.max(np.abs(np.asarray(dots.get_ydata()) - along)) < 60


def test_nyquist_is_not_distorted(drawn: dict[str, Figure]) -> None:
    (axes,) = drawn["nyquist"].axes
    assert axes.get_aspect() == 1
    assert len(axes.patches) == 2


@pytest.mark.parametrize("name", ["bode", "coherence", "nyquist", "sensitivity", "trade_off"])
def test_pictures_are_the_same_every_time(drawn: dict[str, Figure], name: str) -> None:
    pictures = figures.render(drawn[name])
    assert pictures["png"].startswith(b"\x89PNG")
    assert b"<svg" in pictures["svg"]
    if name == "trade_off":
        assert figures.render(drawn[name]) == pictures


def test_symbols() -> None:
    from reports.drawings._canvas import symbol

    assert symbol("ω_m") == r"$\omega_{m}$"
    assert symbol("T_m*") == "$T_{m}^*$"
