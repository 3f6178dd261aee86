"""Uphill to where the least of several margins is largest, known here in closed form."""

import numpy as np
import pytest

from hil.analysis.control_design import Margins
from hil.analysis.tuning import Ascent, Tried, scatter, score

CALM = Margins(20.0, 60.0, 60.0, 10.0, 0.01, 1.2, 5.0, 1.1, 1.0, True)


class Hills:
    """Candidates whose margins and room to a hard limit are functions of their place; what was tried."""

    def __init__(self, margins, room=lambda x: 1.0, runs_beyond=True):
        self._margins, self._room, self._runs_beyond = margins, room, runs_beyond
        self.points, self.scores = [], []

    def __call__(self, points):
        found = []
        for point in points:
            room = self._room(point)
            ran = self._runs_beyond or room >= 0
            margins = {n: f(point) for n, f in self._margins.items()} if ran else {}
            found.append([Tried({}, 0, CALM, {"room": room}, (), margins)])
            self.points.append(point)
            self.scores.append(score(found[-1]))
        return found

    @property
    def best(self):
        return self.points[int(np.argmax(self.scores))]


def climbed(hills, start, rounds=40):
    Ascent(hills, sorted(hills._margins), ["room"]).execute(np.array(start), 0.2, 1e-4, rounds)
    return hills.best


def test_it_ends_at_the_kink_where_two_margins_cross_however_bent_they_are():
    # along x0 the least is largest where (x0 + 0.2)^2 = 1 - x0, that is x0 = 0.3179...; x1 at the crest 0.7
    bend = {
        "up": lambda x: (x[0] + 0.2) ** 2 - (x[1] - 0.7) ** 2,
        "down": lambda x: 1 - x[0] - (x[1] - 0.7) ** 2,
    }
    crossing = (-1.4 + np.sqrt(1.4**2 + 4 * 0.96)) / 2
    assert climbed(Hills(bend), [0.9, 0.1]) == pytest.approx([crossing, 0.7], abs=2e-3)


def test_of_equally_good_places_it_takes_the_one_with_more_elsewhere():
    level = {"worst": lambda x: 0.1 + 0.0 * x[0], "other": lambda x: 0.5 + 0.3 * x[0] - 0.1 * x[1]}
    assert climbed(Hills(level), [0.2, 0.8]) == pytest.approx([1.0, 0.0], abs=1e-6)


@pytest.mark.parametrize("runs_beyond", [True, False])
def test_a_hard_limit_is_kept_and_come_up_to(runs_beyond):
    # uphill is to the right; the limit is a circle around the lower left corner
    hills = Hills({"right": lambda x: x[0]}, lambda x: 0.64 - x[0] ** 2 - x[1] ** 2, runs_beyond)
    best = climbed(hills, [0.3, 0.5])
    assert best == pytest.approx([0.8, 0.0], abs=5e-3)
    assert best @ best <= 0.64


def test_from_beyond_a_hard_limit_it_comes_back_first():
    hills = Hills({"right": lambda x: x[0]}, lambda x: 0.3 - x[0], runs_beyond=False)
    assert climbed(hills, [0.9, 0.5])[0] == pytest.approx(0.3, abs=5e-3)


def test_scattered_points_are_in_the_cube_and_the_same_for_a_seed():
    one, again = (scatter(3, 20, np.random.default_rng(4)) for _ in range(2))
    assert len(one) == 20
    assert np.array_equal(one, again)
    assert 0 <= np.min(one) < 0.1 < 0.9 < np.max(one) <= 1
    assert scatter(3, 0, np.random.default_rng(4)) == []
