from __future__ import annotations

import numpy as np

from reports.stretch import break_at_gaps, envelope


def test_peaks_survive() -> None:
    x = np.arange(20_000) / 1000
    y = np.sin(x)
    y[12_345], y[777] = 9.0, -7.0
    kept_x, kept_y = envelope(x, y, 1000)
    assert len(kept_x) <= 1002
    assert kept_y.max() == 9.0
    assert kept_x[kept_y.argmax()] == 12.345
    assert kept_y.min() == -7.0


def test_every_kept_point_is_a_sample_in_order() -> None:
    x = np.arange(5_003.0)
    y = np.random.default_rng(1).normal(size=5_003)
    kept_x, kept_y = envelope(x, y, 300)
    assert np.all(np.diff(kept_x) > 0)
    assert np.array_equal(kept_y, y[kept_x.astype(int)])
    assert (kept_x[0], kept_x[-1]) == (0.0, 5_002.0)


def test_a_span_without_values_stays_a_gap() -> None:
    x = np.arange(10_000.0)
    y = np.ones(10_000)
    y[4_000:6_000] = np.nan
    y[100] = np.inf
    kept_x, kept_y = envelope(x, y, 200)
    inside = (kept_x > 4_200) & (kept_x < 5_800)
    assert inside.any()
    assert np.all(np.isnan(kept_y[inside]))
    assert not np.isinf(kept_y).any()


def test_a_short_line_is_kept_whole() -> None:
    x = np.arange(10.0)
    assert np.array_equal(envelope(x, x**2, 100)[1], x**2)


def test_a_logarithmic_axis_keeps_its_slow_end() -> None:
    x = np.arange(1, 50_001) / 100
    y = np.random.default_rng(1).uniform(1, 2, 50_000)
    y[40_000] = 9.0
    kept_x, kept_y = envelope(x, y, 1000, logarithmic=True)
    assert len(kept_x) <= 1002
    assert np.array_equal(kept_x[:20], x[:20])
    assert kept_x[kept_y.argmax()] == x[40_000]


def test_no_line_crosses_a_gap_in_time() -> None:
    x = np.concatenate([np.arange(100), 500 + np.arange(100)]) / 1000
    broken_x, broken_y = break_at_gaps(x, np.ones(200))
    assert len(broken_x) == 201
    assert np.isnan(broken_y[100])
    assert np.all(np.diff(broken_x) > 0)
