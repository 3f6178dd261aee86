"""What a slow drift adds to an angle is followed; what is faster stays."""

import numpy as np
import pytest

from hil.analysis.diagnosis.data.turns import (
    Pair,
    around,
    beyond_drift,
    drift_degree,
    pushes_of,
    refused_push,
)
from tests.hil.analysis.diagnosis.one_recording import one_trace


@pytest.mark.parametrize("lasts", [8.0, 20.0, 40.0])
@pytest.mark.parametrize("phase", [0.0, 0.8, 1.6])
def test_a_drift_is_followed_to_a_fiftieth(lasts: float, phase: float) -> None:
    time = np.arange(0.0, lasts, 0.004)
    drift = np.sin(2 * np.pi * time / 25.0 + phase)
    left = around(drift_degree(time, 0.004), drift)
    assert np.std(left) < 0.02
    faster = np.sin(2 * np.pi * time / 2.0)
    assert np.std(around(drift_degree(time, 0.004), faster)) > 0.5 * np.std(faster)


def test_slow_motion_tells_only_in_proportion() -> None:
    alike, other = Pair(), Pair()
    x = np.linspace(-1.0, 1.0, 50)
    alike.add(x, -x)
    other.add(x, x + 2.0 * x**2)
    assert beyond_drift(alike, Pair()) == [alike]
    assert beyond_drift(other, Pair()) == []
    assert beyond_drift(other, alike) == [other, alike]


def test_torque_says_which_way_a_speed_goes() -> None:
    trace = one_trace()
    views = pushes_of([trace], 1, 8.0, 0.02)
    assert all(pair.correlation > 0.9 for pair in views)
    assert refused_push({"wheel_speed_rad_s": views}, ["wheel_speed_rad_s"]) is None
