"""What a picture of a front reaches to."""

import numpy as np
import pytest

from reports.drawings import front
from reports.front_figures import within_sight

POINTS = np.array([[370.0, 4.0, 0.2], [380.0, 5.0, 0.1], [1500.0, 7000.0, 0.07]])
NAMED = [[372.0, 4.8, 0.12], [373.0, 4.6, 0.136]]


def test_far_points_of_a_front_do_not_flatten_the_rest() -> None:
    assert within_sight(POINTS, NAMED).tolist() == [True, True, False]
    assert within_sight(POINTS, []).all()


@pytest.mark.parametrize("named", [{"tuned": NAMED[0], "start": NAMED[1]}, {}])
def test_a_drawn_front_shows_what_is_within_sight(named) -> None:
    figure = front(("peak in N m", "band energy", "response time in s"), POINTS, POINTS, named)
    for axes, column in zip(figure.axes[:2], (1, 2), strict=True):
        assert axes.get_xlim()[1] > 380.0
        assert (axes.get_xlim()[1] < 600.0) == bool(named)
        assert axes.get_ylim()[1] >= POINTS[:2, column].max()
