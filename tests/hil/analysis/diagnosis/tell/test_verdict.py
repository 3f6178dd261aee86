"""When a gap counts as closed: a table."""

import numpy as np
import pytest

from hil.analysis.diagnosis.tell.verdict import open_channels, verdict_on, verdict_without_effects

LAG = ("actuator_lag",)


@pytest.mark.parametrize(
    ("closed", "rounded", "verdict"),
    [
        (True, False, "none"),
        (True, True, "named"),
        (False, False, "unknown"),
        (False, True, "unknown"),
    ],
)
def test_without_effects(closed: bool, rounded: bool, verdict: str) -> None:
    assert verdict_without_effects(closed, rounded) == verdict


@pytest.mark.parametrize(
    ("ids", "before", "share", "left", "verdict"),
    [
        (LAG, 5.0, 0.51, 1.02, "named"),  # the noise is reached
        (LAG, 5.0, 0.49, 1.02, "unknown"),  # and yet half of the gap is still there
        (LAG, 5.0, 0.51, 1.04, "unknown"),
        (LAG, 5.0, 0.96, 1.59, "named"),  # nearly all is closed
        (LAG, 5.0, 0.96, 1.61, "unknown"),
        (LAG, 5.0, 0.94, 1.59, "unknown"),
        (LAG, 50.0, 0.996, 9.0, "named"),  # a large effect is closed less finely
        (LAG, 50.0, 0.994, 9.0, "unknown"),
        (("backlash",), 50.0, 0.91, 9.0, "named"),  # laws of contact are many
        (("backlash",), 50.0, 0.89, 9.0, "unknown"),
        (("actuator_lag", "coulomb_friction"), 50.0, 0.902, 9.0, "named"),
        (("actuator_lag", "coulomb_friction"), 50.0, 0.9005, 9.0, "unknown"),  # a further name must pay
        (("actuator_lag", "sensor_gain"), 50.0, 0.9955, 9.0, "unknown"),
        (LAG, 101.0, 0.91, np.inf, "named"),  # without noise formulas differ
        (LAG, 101.0, 0.89, 1.0, "unknown"),
    ],
)
def test_with_effects(ids: tuple[str, ...], before: float, share: float, left: float, verdict: str) -> None:
    assert verdict_on(ids, before, share, left) == verdict


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
    assert open_channels(ids, np.array(before), np.array(after), apart=False) == open_


@pytest.mark.parametrize(("left", "open_"), [(9.0, False), (12.0, True)])
def test_where_each_channel_has_a_function_each_must_close_to_a_third(left: float, open_: bool) -> None:
    before, after = np.array([500.0, 30.0, 1.0]), np.array([50.0, left, 1.0])
    assert open_channels(LAG, before, after, apart=True) == [False, open_, False]
