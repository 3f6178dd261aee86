from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from test_plans import Step
from tests.test_plans.note_taker import NoteTaker
from tests.test_plans.writing import step_of

TORQUE = st.floats(-500, 500)
SECONDS = st.floats(0.1, 3.0)
COMMON = {"segment": st.just("s"), "quantity": st.sampled_from(["motor_torque", "driving_torque"])}


def kind_of(kind: str, **keys: st.SearchStrategy[Any]) -> st.SearchStrategy[Step]:
    return st.fixed_dictionaries(COMMON | keys).map(lambda values: step_of(kind, **values))


EXCITATIONS = st.one_of(
    kind_of("step", from_nm=TORQUE, to_nm=st.floats(501, 600), before_s=st.floats(0, 2), after_s=SECONDS),
    kind_of("ramp", from_nm=TORQUE, to_nm=TORQUE, duration_s=SECONDS, before_s=SECONDS, after_s=SECONDS),
    kind_of("stairs", levels_nm=st.lists(TORQUE, min_size=2, max_size=5), hold_s=SECONDS),
    kind_of(
        "chirp",
        from_hz=st.floats(0.01, 1),
        to_hz=st.floats(2, 400),
        duration_s=SECONDS,
        amplitude_nm=st.floats(1, 100),
        bias_nm=TORQUE,
        sweep=st.sampled_from(["linear", "logarithmic"]),
        fade_s=st.floats(0, 0.05),
        repeats=st.integers(1, 3),
    ),
    kind_of(
        "multisine",
        seed=st.integers(0, 1000),
        from_hz=st.floats(0, 1),
        to_hz=st.floats(4, 400),
        period_s=st.sampled_from([0.5, 1.0, 2.0]),
        periods=st.integers(1, 3),
        amplitude_nm=st.floats(1, 100),
        bias_nm=TORQUE,
        odd_only=st.booleans(),
        realisations=st.integers(1, 3),
        fade_s=st.floats(0, 1),
    ),
)


@given(EXCITATIONS)
def test_what_is_played_is_what_was_planned(step: Step) -> None:
    conductor = NoteTaker()
    step.execute(conductor)
    segments = tuple(segment for _, _, segment in conductor.played)
    assert segments == step.segments()
    played_s = 0.0
    for _, samples, segment in conductor.played:
        assert segment is not None
        assert 0 <= segment.step_s < segment.end_s
        # Each of at most five parts is rounded to whole samples.
        assert len(samples) * 0.001 == pytest.approx(segment.end_s, abs=0.003)
        assert np.all(np.isfinite(samples))
        played_s += len(samples) * 0.001
    assert played_s == pytest.approx(step.duration_s, abs=0.01)
