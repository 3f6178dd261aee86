"""How far noise alone moves a metric, so that two values within it are not ranked."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from hil.core.recording import Recording
from hil.core.result import Segment
from test_plans.conductor import Array
from test_plans.metrics import Metric, NoValueError

_DRAWS = 12
_SEED = 0
_NORMAL = 0.6745  # median of |x| of a standard normal distribution
_ORDER, _GAIN = 4, np.sqrt(70.0)  # fourth differences of white noise: 1, 4, 6, 4, 1 squared add up to 70
_MARGIN_S = 1.0  # of a recording around a segment: what filters need


def standard_error(metric: Metric, recording: Recording, segment: Segment) -> float:
    """Standard error of a metric, from the noise of its channel propagated through its definition.

    The noise is white, of the size of the channel's fourth differences, which pass next to nothing below a
    tenth of the sampling rate. It is added anew some times; the spread of the values is the error. 0 where
    the metric names no channel, or has no value.
    """
    names = [name for name in metric.channels[:1] if name in recording]
    if not names:
        return 0.0
    name = names[0]
    piece = _around(recording, segment)
    values = piece[name]
    size = noise_of(values)
    if size == 0.0:
        return 0.0
    draws = np.random.default_rng(_SEED)
    found = []
    for _ in range(_DRAWS):
        noisy = replace(
            piece, channels={**piece.channels, name: values + draws.normal(0.0, size, len(values))}
        )
        try:
            found.append(float(metric.compute(noisy, segment)))
        except NoValueError:
            return 0.0
    return float(np.std(found, ddof=1))


def noise_of(values: Array) -> float:
    """Standard deviation of the white noise of a channel, from the median of its fourth differences."""
    known = values[np.isfinite(values)]
    if len(known) <= _ORDER:
        return 0.0
    return float(np.median(np.abs(np.diff(known, _ORDER))) / (_NORMAL * _GAIN))


def _around(recording: Recording, segment: Segment) -> Recording:
    first = recording.rows_before(segment.start_s - _MARGIN_S)
    last = recording.rows_before(segment.end_s + _MARGIN_S)
    return replace(recording, channels=dict(recording.rows(first, last)))
