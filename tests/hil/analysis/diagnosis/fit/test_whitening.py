"""Filters that make coloured errors white with unit variance."""

import numpy as np
import pytest
from scipy.signal import lfilter

from hil.analysis.diagnosis.fit.errors import Errors
from hil.analysis.diagnosis.fit.whitening import whitening_of


def test_coloured_errors_become_white() -> None:
    white = np.random.default_rng(5).normal(0.0, 3.0, (20000, 3))
    slow = lfilter([1.0], [1.0, -0.9], white, axis=0)
    filters = whitening_of([Errors(slow.ravel(), np.zeros((60000, 1)), np.zeros((60000, 3)))])
    for column, taps in enumerate(filters):
        again = lfilter(taps, [1.0], slow[:, column])[50:]
        assert np.std(again) == pytest.approx(1.0, rel=0.03)
        assert abs(np.corrcoef(again[1:], again[:-1])[0, 1]) < 0.03


def test_a_channel_without_errors_is_left_alone() -> None:
    filters = whitening_of([Errors(np.zeros(300), np.zeros((300, 1)), np.zeros((300, 3)))])
    assert np.array_equal(filters, np.eye(3, filters.shape[1])[[0, 0, 0]])
