"""Power density beside that of scipy."""

from __future__ import annotations

from typing import Literal

import numpy as np
import pytest
from scipy import signal

from hil.analysis.power_density import power_density


@pytest.mark.parametrize("average", ["mean", "median"])
@pytest.mark.parametrize("about_mean", [True, False])
@pytest.mark.parametrize(
    ("count", "length"), [(5000, 1024), (5000, 777), (1024, 1024), (1500, 1024), (7, 7), (2, 2)]
)
def test_density_is_that_of_scipy(
    count: int, length: int, about_mean: bool, average: Literal["mean", "median"]
) -> None:
    values = 3.0 + np.random.default_rng(count).standard_normal((count, 3)).cumsum(axis=0)
    detrend: Literal["constant", False] = "constant" if about_mean else False
    theirs = signal.welch(values, 500.0, nperseg=length, axis=0, detrend=detrend, average=average)
    f, ours = power_density(values, 0.002, length, about_mean=about_mean, average=average)
    np.testing.assert_allclose(f, theirs[0], rtol=1e-12)
    np.testing.assert_allclose(ours, theirs[1], rtol=1e-9, atol=1e-12 * float(theirs[1].max()))


def test_white_noise_has_its_variance_whatever_the_average() -> None:
    noise = np.random.default_rng(1).standard_normal((200_000, 1))
    _, mean = power_density(noise, 0.001, 1024)
    _, median = power_density(noise, 0.001, 1024, average="median")
    assert 500.0 * np.mean(mean) == pytest.approx(1.0, rel=0.02)
    assert 500.0 * np.mean(median) == pytest.approx(1.0, rel=0.02)
