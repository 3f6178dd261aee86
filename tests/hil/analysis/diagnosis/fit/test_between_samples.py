"""What a request did between samples that are far apart."""

import dataclasses

import numpy as np
import pytest

from hil.analysis.diagnosis.data.trace import Trace, trace_of
from hil.analysis.diagnosis.fit.between_samples import likelier_requests
from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.problem import Problem, problem_of
from hil.core.channels import INPUT
from hil.core.recording import Recording
from hil.plant import simulate
from tests.hil.analysis.diagnosis.one_recording import MODEL, NOISE, one_trace, recorded

BASE = Hypothesis(MODEL)


def problem(trace: Trace) -> Problem:
    return problem_of([trace], np.array(NOISE), MODEL.parameters["gear_ratio"])


def every_tenth(recording: Recording) -> Trace:
    channels = {name: values[::10] for name, values in recording.channels.items()}
    return trace_of(dataclasses.replace(recording, channels=channels))


def held_for_ten(recording: Recording) -> Recording:
    """The same axle with a request that was held for 10 ms each."""
    torque = np.repeat(recording[INPUT][::10], 10)[: recording.samples]
    return dataclasses.replace(
        recording, channels={**recording.channels, INPUT: torque, **simulate(MODEL, torque, 1e-3)}
    )


@pytest.mark.parametrize(
    ("held", "said"), [(False, "smooth between them"), (True, "held from one to the next")]
)
def test_a_seldom_read_request_is_taken_as_the_base_model_explains_it(held: bool, said: str) -> None:
    recording = recorded(seconds=8.0)
    trace = every_tenth(held_for_ten(recording) if held else recording)
    found = likelier_requests([trace], BASE, problem)
    assert said in found.notes[0]
    assert (found.traces[0] is trace) is held
    assert np.all(found.unsure > 0.0)


def test_a_request_that_was_read_often_is_left_alone() -> None:
    trace = one_trace()
    found = likelier_requests([trace], BASE, problem)
    assert found.traces == [trace]
    assert found.notes == []
    assert found.unsure == pytest.approx(np.zeros(3))
