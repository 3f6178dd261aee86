"""Bad data is refused by name."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hil.analysis.frequency_response import FrequencyResponse, UnfitDataError, estimate, experiments_of
from hil.analysis.frequency_response._quality import clipped_share
from hil.core.errors import BadInputError
from hil.core.recording import Recording
from tests.hil.analysis import paper_plant


def run(recording: Recording, **options: float) -> FrequencyResponse:
    return estimate(experiments_of(recording), **options)  # type: ignore[arg-type]


def chirp_recording(**options: float) -> Recording:
    return paper_plant.recording(paper_plant.chirp(60.0, **options))


def refusal(recording: Recording, **options: float) -> UnfitDataError:
    with pytest.raises(UnfitDataError) as caught:
        run(recording, **options)
    assert caught.value.exit_code == 2
    assert caught.value.fix
    return caught.value


def test_resting_input() -> None:
    recording = chirp_recording()
    recording.channels["motor_torque_ref_nm"][:] = 3.0
    error = refusal(recording)
    assert error.reason == "no_excitation"
    assert "stays at 3" in str(error)


def test_input_outside_the_band() -> None:
    error = refusal(chirp_recording(from_hz=0.1, to_hz=5.0), from_hz=0.1, to_hz=30)
    assert error.reason == "no_excitation"
    assert "-30 Hz" in str(error)


def test_default_band_is_what_is_excited() -> None:
    frf = run(paper_plant.recording(paper_plant.chirp(120.0, from_hz=0.5, to_hz=5.0)))
    assert 0.3 < frf.frequency_hz[0] < 0.55
    assert 4.5 < frf.frequency_hz[-1] < 6.5
    assert any(note.startswith("band") for note in frf.notes)


def test_clipped_input() -> None:
    recording = chirp_recording()
    torque = recording.channels["motor_torque_ref_nm"]
    np.clip(torque, -45.0, 45.0, out=torque)
    error = refusal(recording)
    assert error.reason == "clipped_input"
    assert "45" in str(error)


@given(
    st.floats(0.05, 2.0),
    st.floats(0.0, 1.0),
    st.floats(1.0, 200.0),
)
@settings(max_examples=40, deadline=None)
def test_a_quantised_sine_is_not_clipped(frequency_hz: float, quantum: float, amplitude: float) -> None:
    sine = amplitude * np.sin(2 * np.pi * frequency_hz * np.arange(20_000) * 0.001)
    if quantum > 0.01 * amplitude:
        quantum = 0.01 * amplitude
    values = np.round(sine / quantum) * quantum if quantum > 1e-3 else sine
    if np.ptp(values) > amplitude:
        assert clipped_share(values) == 0.0


def test_steps_are_not_clipped() -> None:
    levels = np.repeat(np.random.default_rng(0).choice([-10.0, 10.0], 100), 200)
    assert clipped_share(levels) == 0.0


def test_low_coherence_says_where() -> None:
    recording = chirp_recording()
    rng = np.random.default_rng(0)
    speed = recording.channels["wheel_speed_rad_s"]
    speed += 3 * np.std(speed) * rng.standard_normal(len(speed))
    error = refusal(recording)
    assert error.reason == "low_coherence"
    assert "wheel_speed_rad_s" in str(error)
    assert "Hz" in str(error)


def test_too_short_for_the_lowest_frequency() -> None:
    error = refusal(chirp_recording(), from_hz=0.01)
    assert error.reason == "too_short"
    assert "periods of 0.01 Hz" in str(error)


def test_too_slow_for_the_highest_frequency() -> None:
    recording = chirp_recording()
    slow = Recording({k: v[::50] for k, v in recording.channels.items()}, Path("slow"))
    assert refusal(slow, from_hz=0.1, to_hz=30).reason == "too_short"


def test_channel_that_never_moves() -> None:
    recording = chirp_recording()
    recording.channels["shaft_torque_nm"][:] = 0.25
    error = refusal(recording)
    assert error.reason == "channel_never_moves"
    assert "shaft_torque_nm" in str(error)


def test_jittered_time_stamps_are_resampled_and_noted() -> None:
    recording = chirp_recording()
    rng = np.random.default_rng(1)
    kept = np.sort(rng.choice(60_000, 57_000, replace=False))
    thinned = Recording({k: v[kept] for k, v in recording.channels.items()}, Path("uneven"))
    frf = run(thinned)
    assert any("resampled" in note for note in frf.notes)
    truth = paper_plant.response("motor_speed_rad_s", frf.frequency_hz)
    middle = (frf.frequency_hz > 1) & (frf.frequency_hz < 15)
    assert np.max(np.abs(frf.response[0] / truth - 1)[middle]) < 0.05


def test_hopeless_gaps_are_refused() -> None:
    recording = chirp_recording()
    kept = np.r_[0:20_000, 23_000:60_000]
    torn = Recording({k: v[kept] for k, v in recording.channels.items()}, Path("torn"))
    with pytest.raises(UnfitDataError, match=r"near 19\.99") as caught:
        experiments_of(torn)
    assert caught.value.reason == "uneven_time"


def test_band_upside_down() -> None:
    with pytest.raises(BadInputError, match="band runs from 20 to 10"):
        run(chirp_recording(), from_hz=20, to_hz=10)


def test_steps_give_a_response() -> None:
    """A torque that jumps between two levels at random times excites the whole band."""
    rng = np.random.default_rng(4)
    torque = np.repeat(rng.choice([-40.0, 40.0], 600), 200)
    frf = run(paper_plant.recording(torque), from_hz=0.1, to_hz=20)
    truth = paper_plant.response("shaft_torque_nm", frf.frequency_hz)
    assert np.median(np.abs(frf.of("shaft_torque_nm") / truth - 1)) < 0.03
