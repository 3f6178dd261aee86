"""The crossing of the play keeps what the documentation promises of it, on cars that are drawn."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.play_crossing import METRICS, cars, controllers, figures

CARS = 33


@pytest.mark.slow
def test_time_in_play_and_clunk_are_less_at_no_cost_of_response_and_jerk() -> None:
    drawn, compared = cars(CARS), controllers()
    lead, crossing = (figures(compared[name], drawn) for name in ("shipped lead", "crossing of the play"))
    change = dict(zip(METRICS, crossing.median / lead.median - 1, strict=True))
    assert change["time_in_play"] < -0.30
    assert change["clunk"] < -0.50
    assert change["response_time"] < 0.0
    assert change["jerk"] < 0.0
    assert change["overshoot"] < 0.0
    assert np.all(crossing.nine_in_ten < lead.nine_in_ten)
