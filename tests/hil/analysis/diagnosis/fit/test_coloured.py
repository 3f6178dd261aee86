"""What coloured errors pull is what their covariance says."""

import numpy as np
import pytest
from scipy.linalg import toeplitz
from scipy.signal import lfilter

from hil.analysis.diagnosis.fit.coloured import coloured_spread
from hil.analysis.diagnosis.fit.errors import Errors

BLOCKS, NUMBERS = 2000, 3


def errors_of(noise: np.ndarray, channel: int, seed: int = 0) -> Errors:
    """Errors in one channel, and numbers that show there at times of their own."""
    slopes = np.zeros((BLOCKS, 3, NUMBERS))
    time = np.linspace(0.0, 1.0, BLOCKS)
    for number, at in enumerate((0.2, 0.5, 0.7)):
        slopes[:, channel, number] = np.exp(-(((time - at) / 0.1) ** 2)) * np.sin(40.0 * (number + 1) * time)
    rows = np.zeros((BLOCKS, 3))
    rows[:, channel] = noise
    return Errors(rows.ravel(), slopes.reshape(-1, NUMBERS), np.zeros((3 * BLOCKS, 5)))


@pytest.mark.parametrize("channel", [0, 2])
@pytest.mark.parametrize("pole", [0.0, 0.9, -0.5])
def test_the_spread_is_that_of_the_errors_own_covariance(pole: float, channel: int) -> None:
    """AR(1) of unit variance: neighbours n apart are alike by pole^n."""
    rng = np.random.default_rng(3)
    noises = [np.sqrt(1 - pole**2) * lfilter([1.0], [1.0, -pole], rng.normal(size=BLOCKS)) for _ in range(8)]
    recordings = [errors_of(noise, channel) for noise in noises]
    seen = recordings[0].by_coordinate.reshape(-1, 3, NUMBERS)[:, channel]
    expected = len(recordings) * seen.T @ toeplitz(pole ** np.arange(BLOCKS)) @ seen
    found = coloured_spread(recordings)
    assert np.diag(found) == pytest.approx(np.diag(expected), rel=0.25)
    alike, expected_alike = (m / np.sqrt(np.outer(np.diag(m), np.diag(m))) for m in (found, expected))
    assert alike == pytest.approx(expected_alike, abs=0.1)


def test_what_initial_values_take_up_pulls_nothing() -> None:
    one = errors_of(np.random.default_rng(0).normal(size=BLOCKS), 0)
    taken = Errors(one.rows, one.by_coordinate, one.by_coordinate[:, :1])
    found = coloured_spread([taken])
    assert found[0] == pytest.approx(np.zeros(NUMBERS), abs=1e-9 * found[1, 1])


def test_recordings_of_any_length_count_together() -> None:
    whole = errors_of(np.random.default_rng(0).normal(size=BLOCKS), 1)
    half = Errors(
        whole.rows[: 3 * BLOCKS // 2], whole.by_coordinate[: 3 * BLOCKS // 2], np.zeros((3 * BLOCKS // 2, 5))
    )
    both = np.diag(coloured_spread([whole, half]))
    assert both == pytest.approx(
        np.diag(whole.by_coordinate.T @ whole.by_coordinate + half.by_coordinate.T @ half.by_coordinate),
        rel=0.3,
    )


def test_without_any_number_nothing_is_pulled() -> None:
    whole = errors_of(np.random.default_rng(0).normal(size=BLOCKS), 1)
    assert coloured_spread([Errors(whole.rows, whole.by_coordinate[:, :0], whole.by_start)]).shape == (0, 0)
