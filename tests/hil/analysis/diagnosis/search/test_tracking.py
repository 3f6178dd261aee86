"""Following a ripple's phase where the speed that it follows was not measured, or a simulation diverges."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hil.analysis.diagnosis.data.noise import noise_levels, usable_noise
from hil.analysis.diagnosis.data.sanity import examine
from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.problem import problem_of
from hil.analysis.diagnosis.search.tracking import _smoothed, _Windows, track
from hil.core.channels import INPUT, OUTPUTS
from hil.core.model import EffectUse
from tests.hil.analysis.degenerate import MODEL, recording

RIPPLE = {"order": 3.0, "amplitude_nm": 5.0, "phase_rad": 0.5}


def followed(id_: str, *channels: str, amplitude_nm: float = 5.0) -> np.ndarray:
    """Coordinates after tracking one ripple in a recording of these channels alone."""
    whole = recording("as it should be")
    part = dataclasses.replace(whole, channels={n: whole[n] for n in ("time_s", INPUT, *channels)})
    traces, _ = examine(MODEL, [part])
    noise = usable_noise(noise_levels(traces))
    problem = problem_of(traces, noise, MODEL.parameters["gear_ratio"])
    hypothesis = Hypothesis(MODEL, (EffectUse(id_, {**RIPPLE, "amplitude_nm": amplitude_nm}),))
    return track(problem, hypothesis, hypothesis.start(), problem.first_starts())[0]


@pytest.mark.parametrize("id_", ["wheel_order_disturbance", "motor_order_ripple"])
@pytest.mark.parametrize("channel", OUTPUTS)
def test_one_channel_alone_is_enough(id_: str, channel: str) -> None:
    assert np.all(np.isfinite(followed(id_, channel)))


@pytest.mark.parametrize("amplitude_nm", [1e200, np.inf])
def test_a_simulation_that_diverges_says_nothing_of_the_phase(amplitude_nm: float) -> None:
    found = followed("wheel_order_disturbance", *OUTPUTS, amplitude_nm=amplitude_nm)
    assert not np.any(np.isnan(found))


@pytest.mark.parametrize("size", [np.nan, np.inf, 1e200])
def test_windows_that_broke_down_leave_the_phase_where_it_was(size: float) -> None:
    count = 12
    own = np.tile(np.eye(2), (count, 1, 1))
    own[3] = size
    windows = _Windows(own, np.ones((count, 2)), np.linspace(0.0, 1.1, count), np.linspace(0.0, 11.0, count))
    with np.errstate(all="ignore"):  # as a diagnosis computes
        path = _smoothed(windows, np.full(count, 0.5), 1e60, 1e-6)
    assert np.all(np.isfinite(path))
