from __future__ import annotations

import numpy as np
import pytest

from reports.drawings import distribution

ENERGIES = np.linspace(0.02, 0.4, 60)


def test_an_energy_does_not_begin_below_zero() -> None:
    for limits in ((), (0.3,), (0.05,)):
        (axes,) = distribution("Band energy", {"one": ENERGIES}, limits).axes
        assert axes.get_xlim()[0] >= 0.0
        assert min(path.get_extents().x0 for path in (p.get_path() for p in axes.patches)) >= 0.0
    (axes,) = distribution("Zero", {"one": np.zeros(9)}, ()).axes
    assert axes.get_xlim()[0] >= 0.0


def test_every_value_is_counted_once() -> None:
    figure = distribution("Band energy", {"one": ENERGIES}, (0.05,))
    (stairs, *_) = figure.axes[0].patches
    assert np.sum(stairs.get_data().values) == pytest.approx(100.0)  # type: ignore[attr-defined]


def test_a_far_limit_is_named_within_the_axes() -> None:
    figure = distribution("Peak in N m", {"gain_stabilization": ENERGIES}, (564.0,))
    (note,) = figure.axes[0].texts
    assert note.get_text() == "limit 564 →"
    figure.draw_without_rendering()
    box, room = note.get_window_extent(), figure.axes[0].get_window_extent()
    assert room.x0 <= box.x0
    assert box.x1 <= room.x1


def test_a_near_limit_is_a_line_with_its_value() -> None:
    figure = distribution("Peak in N m", {"one": ENERGIES}, (0.45,))
    assert "limit 0.45" in figure.axes[0].get_legend_handles_labels()[1]
