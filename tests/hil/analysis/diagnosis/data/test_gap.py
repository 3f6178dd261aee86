"""Ratios of errors, over channels, bands and conditions."""

from dataclasses import replace

import numpy as np
import pytest

from hil.analysis.diagnosis.data.gap import BANDS_HZ, CONDITIONS, channel_gaps, conditions_of, gap_map
from hil.core.channels import OUTPUTS
from tests.hil.analysis.diagnosis.one_recording import one_series


def test_a_gap_is_error_over_what_the_channel_does() -> None:
    trace = one_series()
    spread = np.std(trace.samples, axis=0)
    gaps = channel_gaps([trace], 0.1 * spread, [trace.samples - 0.5 * spread])
    assert list(gaps) == list(OUTPUTS)
    for gap in gaps.values():
        assert (gap.gap, gap.noise_floor) == (pytest.approx(0.5), pytest.approx(0.1))


def test_an_error_stands_in_its_band() -> None:
    trace = one_series()
    wave = np.sin(2 * np.pi * 12.0 * np.arange(len(trace.samples)) * trace.dt)
    found = gap_map([trace], np.ones(3), [trace.samples - wave[:, None]])
    assert [BANDS_HZ[i] for i in np.argmax(found.by_band[0], axis=1)] == [(10.0, 15.0)] * 3


def test_recordings_that_lack_a_channel_do_not_thin_its_error_out() -> None:
    trace = one_series()
    without = replace(
        trace, measured=trace.measured * [1.0, np.nan, 1.0], samples=trace.samples * [1.0, np.nan, 1.0]
    )
    alone = gap_map([trace], np.ones(3), [trace.samples - 2.0]).by_condition
    both = gap_map([trace, without], np.ones(3), [trace.samples - 2.0] * 2).by_condition
    assert both[:, 1] == pytest.approx(alone[:, 1], nan_ok=True)
    lacking = gap_map([without], np.ones(3), [trace.samples - 2.0]).by_condition
    assert np.isnan(lacking[:, 1]).all()
    assert lacking[:, 0] == pytest.approx(alone[:, 0], nan_ok=True)


def test_every_sample_has_one_condition() -> None:
    trace = one_series()
    assert np.all(conditions_of(trace.samples, trace.torque, trace.dt).sum(axis=0) == 1.0)


@pytest.mark.parametrize(
    ("speed", "torque", "condition"),
    [
        (0.0, 1.0, "near standstill"),
        (30.0, 9.0, "large torque"),
        (90.0, 1.0, "high speed"),
        (30.0, 1.0, "elsewhere"),
    ],
)
def test_conditions(speed: float, torque: float, condition: str) -> None:
    speeds = np.array([100.0, *[speed] * 9])
    samples = np.column_stack([speeds, speeds / 10.0, speeds])
    found = conditions_of(samples, np.array([10.0, *[torque] * 9]), 0.01)
    assert CONDITIONS[int(np.argmax(found[:, -1]))] == condition


def test_a_change_of_sign_is_a_reversal_for_a_while() -> None:
    samples = np.full((100, 3), 50.0)
    torque = np.where(np.arange(100) < 50, 1.0, -1.0)
    rows = conditions_of(samples, torque, 0.01)[CONDITIONS.index("torque reversals")]
    assert (rows[45], rows[55], rows[70]) == (0.0, 1.0, 0.0)
