"""Ride comfort: against the weights that ISO 2631-1 tabulates, and against sines of known acceleration."""

from __future__ import annotations

from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

from hil.core.recording import Recording
from hil.core.result import Segment
from test_plans.metrics import NoValueError, RideComfort, VibrationDose
from test_plans.metrics.ride_comfort import horizontal_weighting, weighting_sections

#: Table 3 of ISO 2631-1:1997, W_d times 1000. At 10 Hz it has 212, where its own annex A gives 202.
TABULATED = {
    0.2: 243, 0.25: 365, 0.315: 530, 0.4: 713, 0.5: 853, 0.63: 944, 0.8: 992, 1: 1011, 1.25: 1008, 1.6: 968,
    2: 890, 2.5: 776, 3.15: 642, 4: 512, 5: 409, 6.3: 323, 8: 253, 12.5: 161, 16: 125, 20: 100, 25: 80,
    31.5: 63.2, 40: 49.4, 50: 38.8, 63: 29.5, 80: 21.1, 100: 14.1,
}  # fmt: skip
SEGMENT = Segment(id="s", start_s=0.0, step_s=1.0, end_s=21.0)


def recorded(speed_m_s: np.ndarray, rate_hz: float = 1000.0, late_s: float = 0.0) -> Recording:
    time = np.arange(len(speed_m_s)) / rate_hz + late_s
    return Recording({"time_s": time, "vehicle_speed_m_s": speed_m_s}, Path("r.mcap"))


@pytest.mark.parametrize(("frequency_hz", "weight"), TABULATED.items())
def test_weights_are_those_of_the_standard(frequency_hz, weight):
    found = 1000 * float(horizontal_weighting(np.array([frequency_hz]))[0])
    # the table is for exact third octaves, 10**(n/10), and rounded
    exact = 10 ** (round(10 * np.log10(frequency_hz)) / 10)
    between = sorted(1000 * float(horizontal_weighting(np.array([f]))[0]) for f in (frequency_hz, exact))
    assert between[0] * 0.995 <= weight <= between[1] * 1.005, found


@pytest.mark.parametrize("frequency_hz", [0.8, 2.0, 10.6, 40.0])
def test_a_sine_gives_its_rms_acceleration_times_its_weight(frequency_hz):
    time = np.arange(22_000) / 1000
    omega = 2 * np.pi * frequency_hz
    speed = 5.0 + 0.3 * time + 0.4 / omega * np.sin(omega * time)  # 0.4 m/s² on top of 0.3
    weight = float(horizontal_weighting(np.array([frequency_hz]))[0])
    found = RideComfort().compute(recorded(speed), SEGMENT)
    assert found == pytest.approx(0.4 / np.sqrt(2) * weight, rel=0.01)


def test_constant_acceleration_does_not_count():
    assert RideComfort().compute(recorded(0.8 * np.arange(22_000) / 1000), SEGMENT) < 1e-9


@pytest.mark.parametrize("rate_hz", [199.0, 100.0])
def test_samples_too_few_for_100_hz_have_no_value(rate_hz):
    speed = np.ones(round(22 * rate_hz))
    with pytest.raises(NoValueError, match=f"^{rate_hz:g} samples a second do not reach 100 Hz$"):
        RideComfort().compute(recorded(speed, rate_hz), SEGMENT)


@pytest.mark.parametrize("length_s", [0.5, 2.499])
def test_a_window_shorter_than_a_period_of_the_lowest_frequency_has_no_value(length_s):
    short = SEGMENT.model_copy(update={"end_s": SEGMENT.step_s + length_s})
    with pytest.raises(NoValueError, match=f"^{length_s:.4g} s do not hold a period of 0.4 Hz$"):
        RideComfort().compute(recorded(np.ones(22_000)), short)


def test_a_window_of_one_period_of_the_lowest_frequency_is_enough():
    short = SEGMENT.model_copy(update={"end_s": SEGMENT.step_s + 2.5})
    omega = 2 * np.pi * 2.0
    speed = 0.4 / omega * np.sin(omega * np.arange(22_000) / 1000)
    assert RideComfort().compute(recorded(speed), short) == pytest.approx(0.4 / np.sqrt(2) * 0.890, rel=0.1)


def test_200_samples_a_second_are_enough():
    omega = 2 * np.pi * 2.0
    speed = 0.4 / omega * np.sin(omega * np.arange(4400) / 200.0)
    found = RideComfort().compute(recorded(speed, rate_hz=200.0), SEGMENT)
    assert found == pytest.approx(0.4 / np.sqrt(2) * 0.890, rel=0.01)


def test_the_sample_at_the_windows_end_belongs_to_what_follows():
    # stamps lie a third of a sample early: what follows is not looked at to fill that
    time = np.arange(22_000) / 1000
    smooth = np.sin(2 * np.pi * time)
    usual, broken = recorded(smooth, late_s=-3e-4), recorded(smooth.copy(), late_s=-3e-4)
    broken["vehicle_speed_m_s"][21_000] = 100.0
    assert RideComfort().compute(broken, SEGMENT) == RideComfort().compute(usual, SEGMENT)
    broken["vehicle_speed_m_s"][20_999] = 100.0
    assert RideComfort().compute(broken, SEGMENT) > 1.0


def test_it_is_an_acceleration():
    assert RideComfort().unit == "m/s²"
    assert "W_d of ISO 2631-1:1997" in RideComfort().definition


@pytest.mark.parametrize("frequency_hz", [1.0, 4.0, 10.0])
def test_a_sine_gives_the_dose_of_the_closed_form(frequency_hz):
    """The fourth power of a sine has the mean 3/8: VDV = |H| A (3 T / 8)^(1/4), H as sampled."""
    time = np.arange(41_001) / 1000
    omega = 2 * np.pi * frequency_hz
    turned = np.exp(-1j * omega / 1000)
    gain = np.prod(
        [
            np.abs(np.polyval(b[::-1], turned) / np.polyval(a[::-1], turned))
            for b, a in weighting_sections(1e-3)
        ]
    )
    segment = Segment(id="s", start_s=0.0, step_s=0.1, end_s=41.0)  # too short before to show a slope
    found = VibrationDose(from_s=19.901, to_s=39.9).compute(recorded(0.02 * np.sin(omega * time)), segment)
    assert found == pytest.approx(gain * 0.02 * (3 * 20 / 8) ** 0.25, rel=1e-9)
    weight = float(horizontal_weighting(np.array([frequency_hz]))[0])
    assert gain == pytest.approx(omega * weight, rel=5e-3)


def test_scipy_filters_the_same_dose():
    from scipy import signal

    rng = np.random.default_rng(3)
    speed = np.cumsum(0.001 * rng.standard_normal(21_001)) * 0.1
    b: Any = [1.0]
    a: Any = [1.0]
    low, high, middle = 2 * np.pi * 0.4, 2 * np.pi * 100, 2 * np.pi * 2.0
    for above, below in (
        ([1, 0, 0], [1, np.sqrt(2) * low, low**2]),
        ([high**2, 0], [1, np.sqrt(2) * high, high**2]),
        ([middle, middle**2], [1, middle / 0.63, middle**2]),
    ):
        b, a = np.polymul(b, above), np.polymul(a, below)
    zeros, poles, gain = cast("tuple[Any, Any, Any]", signal.tf2zpk(b, a))
    zpk: Any = signal.bilinear_zpk(zeros, poles, gain, fs=1000)
    segment = Segment(id="s", start_s=0.0, step_s=0.0, end_s=21.0)
    weighted = signal.sosfilt(signal.zpk2sos(*zpk), speed - speed[0])
    wanted = (np.sum(weighted**4) / 1000) ** 0.25
    assert VibrationDose().compute(recorded(speed), segment) == pytest.approx(wanted, rel=1e-9)


def test_an_acceleration_that_was_there_before_adds_no_dose():
    time = np.arange(22_000) / 1000
    assert VibrationDose().compute(recorded(3.0 + 0.8 * time), SEGMENT) < 1e-9
    blow = 3.0 + 0.8 * time + 0.05 * np.maximum(time - 2.0, 0.0)
    twice = 3.0 + 0.8 * time - 0.1 * np.maximum(time - 2.0, 0.0)
    one, two = (VibrationDose().compute(recorded(v), SEGMENT) for v in (blow, twice))
    assert two == pytest.approx(2 * one, rel=1e-9)
