"""What is smaller than an instrument's own error is a correction, not a finding."""

import pytest

from hil.analysis.diagnosis.findings.named import worth_naming
from hil.core.channels import OUTPUTS
from hil.core.model import EffectUse
from tests.hil.analysis.diagnosis.one_recording import MODEL, one_series


@pytest.mark.parametrize(
    ("use", "worth"),
    [
        (EffectUse("channel_skew", {"channel": OUTPUTS[2], "delay_s": 9.5e-6}), False),
        (EffectUse("channel_skew", {"channel": OUTPUTS[2], "delay_s": -9.5e-6}), False),
        (EffectUse("channel_skew", {"channel": OUTPUTS[2], "delay_s": 1e-4}), True),
        (EffectUse("sensor_gain", {"channel": OUTPUTS[0], "gain": 1.0002}), False),
        (EffectUse("sensor_gain", {"channel": OUTPUTS[0], "gain": 0.998}), True),
        (EffectUse("sensor_gain", {"channel": OUTPUTS[0], "gain": 0.0}), True),
        (EffectUse("coulomb_friction", {"torque_nm": 1e-3}), False),  # of 20 N m
        (EffectUse("coulomb_friction", {"torque_nm": 1e-3, "offset_nm": 0.1}), True),
        (EffectUse("dead_time", {"extra_delay_s": 3e-4}), False),  # of 8 ms, which 2 % may be off
        (EffectUse("dead_time", {"extra_delay_s": 4e-4}), True),
        (EffectUse("backlash", {"half_gap_rad": 1e-6}), True),  # what the data prove
    ],
)
def test_each_effect_has_a_size_worth_naming(use: EffectUse, worth: bool) -> None:
    assert worth_naming(use, [one_series()], {}, MODEL) is worth


def test_a_user_sets_another_size() -> None:
    skew = EffectUse("channel_skew", {"channel": OUTPUTS[2], "delay_s": 9.5e-6})
    assert worth_naming(skew, [one_series()], {"channel_skew": 5e-6}, MODEL)
    assert not worth_naming(skew, [one_series()], {"channel_skew": 1e-5}, MODEL)
