"""Single readings that no axle gives are left out and told; what a channel does is not."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil.analysis.missing_effects import series_of
from hil.analysis.spikes import SPIKES, without_spikes
from tests.hil.analysis.diagnosis.one_recording import MODEL, recorded

WHEEL = "wheel_speed_rad_s"


def test_a_glitch_is_replaced_and_told_with_its_place() -> None:
    recording = recorded()
    clean = series_of(MODEL, [recording])[0]
    recording.channels[WHEEL] = recording[WHEEL].copy()
    recording.channels[WHEEL][2000] = 5000.0
    mended = series_of(MODEL, [recording])[0]
    assert mended.notes == (
        f"a single reading of 5000 at 2 s in {WHEEL} omitted: no axle can move so far and back in a sample",
    )
    assert mended.samples[2000, 1] == pytest.approx(clean.samples[[1999, 2001], 1].mean())
    others = np.arange(len(clean.samples)) != 2000
    assert np.array_equal(mended.samples[others], clean.samples[others])


def test_several_are_counted_and_many_are_what_the_channel_does() -> None:
    values = np.sin(np.arange(4000) / 100.0)
    values[100:1100:100] += 50.0
    mended, said = without_spikes(values, WHEEL, 1e-3)
    assert said.startswith("10 single readings, the first of 50.84 at 0.1 s, in")
    assert np.max(mended) < 1.1
    values[:: len(values) // (2 * SPIKES)] -= 80.0
    assert without_spikes(values, WHEEL, 1e-3) == (values, "")


@given(st.integers(0, 10_000), st.sampled_from([0.0, 0.5, 5.0]), st.sampled_from([0.0, 1.0, 30.0]))
def test_noise_steps_and_rounding_are_no_glitches(seed: int, step: float, swing: float) -> None:
    rng = np.random.default_rng(seed)
    values = rng.standard_normal(2000) + swing * np.sign(np.sin(np.arange(2000) / 50.0))
    if step:
        values = np.round(values / step) * step
    assert without_spikes(values, WHEEL, 1e-3)[1] == ""
