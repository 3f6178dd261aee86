"""A mistake is named where the model knows the recording without it, and not as it stands."""

import dataclasses

import numpy as np
import pytest

from hil.analysis.diagnosis.data.mistakes import mistaken
from hil.analysis.diagnosis.data.noise import noise_levels
from hil.analysis.diagnosis.data.trace import Trace, trace_of
from tests.hil.analysis.diagnosis.one_recording import MODEL, recorded

RPM = 60.0 / (2.0 * np.pi)


def with_outputs(*factors: float, torque: float = 1.0) -> Trace:
    one = recorded(seconds=8.0)
    names = ("motor_speed_rad_s", "wheel_speed_rad_s", "shaft_torque_nm")
    channels = {name: one[name] * factor for name, factor in zip(names, factors, strict=True)}
    channels["motor_torque_ref_nm"] = torque * one["motor_torque_ref_nm"]
    return trace_of(dataclasses.replace(one, channels={**one.channels, **channels}))


def said(trace: Trace) -> str:
    found = mistaken(MODEL, [trace], noise_levels([trace]))
    return "" if found is None else found.what


@pytest.mark.parametrize(
    ("trace", "what"),
    [
        (with_outputs(1.0, 1.0, 1.0), ""),
        (with_outputs(RPM, 1.0, 1.0), "motor_speed_rad_s looks like rpm"),
        (with_outputs(1.0, 1.0, -1.0), "shaft_torque_nm looks inverted"),
        (with_outputs(1.0, 1.0, 1e-3), "shaft_torque_nm looks like kN m"),
        (with_outputs(1.0, 1.0, 1.0, torque=-1.0), "motor_torque_ref_nm looks inverted"),
    ],
)
def test_a_mistake_is_named(trace: Trace, what: str) -> None:
    assert said(trace).startswith(what)
    assert bool(said(trace)) is bool(what)
