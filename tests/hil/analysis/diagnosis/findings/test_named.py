"""What is stated of an effect: whether it is worth a name, where it acts; and where a gap stays."""

from __future__ import annotations

import numpy as np
import pytest

from hil.analysis.diagnosis.data.gap import gap_map
from hil.analysis.diagnosis.findings.named import band_of_gap, clean, where_changed, worth_naming
from hil.core.channels import OUTPUTS
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse
from tests.hil.analysis.diagnosis.one_recording import MODEL, NOISE, one_series


def test_phases_lie_within_half_a_turn_and_what_was_not_fitted_is_left_out() -> None:
    ripple = EffectUse("motor_order_ripple", {"order": 8.0, "amplitude_nm": 1.0, "phase_rad": 7.0})
    assert clean(ripple).values["phase_rad"] == pytest.approx(7.0 - 2.0 * np.pi)
    friction = EffectUse("coulomb_friction", EFFECTS["coulomb_friction"].completed({"torque_nm": 2.0}))
    assert clean(friction).values == {"torque_nm": 2.0}


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


LEVELS = np.array(NOISE)


def test_a_wave_in_one_channel_is_placed() -> None:
    trace = one_series()
    wave = np.zeros_like(trace.samples)
    wave[:, 2] = 30.0 * np.sin(2 * np.pi * 10.0 * np.arange(len(wave)) * trace.dt)
    maps = [gap_map([trace], LEVELS, [s]) for s in (trace.samples - wave, trace.samples)]
    found = where_changed([trace], LEVELS, [trace.samples - wave], [trace.samples], *maps)
    assert found.channels == (OUTPUTS[2],)
    assert found.band_hz[0] < 10.0 < found.band_hz[1]


@pytest.mark.parametrize("frequency_hz", [7.0, 13.0])
def test_a_line_that_stays_is_called_one(frequency_hz: float) -> None:
    trace = one_series(seconds=16.0)
    time = np.arange(len(trace.samples)) * trace.dt
    noise = np.random.default_rng(3).normal(0.0, 1.0, len(time))
    shown = trace.samples.copy()
    shown[:, 2] += 3.0 * NOISE[2] * np.sin(2 * np.pi * frequency_hz * time) + NOISE[2] * noise
    words = band_of_gap([trace], LEVELS, [shown], 2)
    assert words.startswith("it is a line at ")
    assert float(words.split()[-2]) == pytest.approx(frequency_hz, abs=0.2)


def test_a_gap_that_is_broad_lies_between_two_frequencies() -> None:
    trace = one_series(seconds=16.0)
    time = np.arange(len(trace.samples)) * trace.dt
    shown = trace.samples.copy()
    shown[:, 0] += 5.0 * NOISE[0] * np.sin(2 * np.pi * (2.0 * time + 0.5 * time**2))  # 2 to 18 Hz
    words = band_of_gap([trace], LEVELS, [shown], 0)
    low, high = (float(part) for part in words.split() if part.replace(".", "").isdigit())
    assert 2.0 < low < 6.0
    assert 13.0 < high < 19.0
