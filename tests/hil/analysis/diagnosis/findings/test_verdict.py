"""When the gap of a channel counts as closed: a table."""

import numpy as np
import pytest

from hil.analysis.diagnosis.findings.thresholds import CHANNEL_NOISES, NOISELESS
from hil.analysis.diagnosis.findings.verdict import open_channels

LAG = ("actuator_lag",)


@pytest.mark.parametrize(
    ("ids", "before", "after", "open_"),
    [
        (LAG, (20.0, 20.0, 20.0), (1.4, 1.0, 4.5), [False, False, False]),  # within a quarter of the gap
        (LAG, (20.0, 3.0, 1.0), (1.4, 2.9, 1.0), [False, True, False]),  # one channel kept its gap
        (LAG, (20.0, 1.4, 1.0), (1.4, 1.39, 1.0), [False, True, False]),  # a small one too
        (LAG, (20.0, 1.0, 1.0), (1.4, 2.0, 1.0), [False, True, False]),  # made worse
        (LAG, (20.0, 1.0, 1.0), (1.4, 1.1, 1.0), [False, False, False]),  # within the noise's own scatter
        (("backlash",), (20.0, 1.0, 1.0), (5.0, 1.0, 1.0), [False, False, False]),  # laws of contact are many
        (LAG, (20.0, 1.0, 1.0), (6.0, 1.0, 1.0), [True, False, False]),
        (LAG, (500.0, 30.0, 1.0), (50.0, 28.0, 1.0), [False, False, False]),  # a matter of formulas
        (LAG, (500.0, 30.0, 1.0), (50.0, 34.0, 1.0), [False, True, False]),  # and yet not worse
        (LAG, (500.0, 1.2, 1.0), (50.0, 1.4, 1.6), [False, False, True]),
    ],
)
def test_each_channel_must_close(
    ids: tuple[str, ...], before: tuple[float, ...], after: tuple[float, ...], open_: list[bool]
) -> None:
    assert open_channels(ids, np.array(before), np.array(after)) == open_


@pytest.mark.parametrize(("before", "open_"), [(0.9 * NOISELESS, True), (1.1 * NOISELESS, False)])
def test_far_from_the_noise_a_channel_may_keep_its_gap(before: float, open_: bool) -> None:
    kept = 2.0 * CHANNEL_NOISES
    found = open_channels(LAG, np.array([before, kept, 1.0]), np.array([before / 10.0, kept, 1.0]))
    assert found[1] is open_
