"""The price of a name, and which fit is preferred."""

import pytest

from hil.analysis.diagnosis.search.evidence import price, rank
from hil.analysis.diagnosis.search.thresholds import DOUBT, FAR, PRICE
from hil.core.channels import OUTPUTS
from hil.core.model import EffectUse
from tests.hil.analysis.diagnosis.one_recording import left

LAG = EffectUse("actuator_lag", {"time_constant_s": 0.01})
MOUNT = EffectUse(
    "mount_mode",
    {"housing_inertia_kg_m2": 3.0, "mount_stiffness_nm_rad": 1e4, "mount_damping_nms_rad": 10.0},
)
GAIN = EffectUse("sensor_gain", {"channel": OUTPUTS[0], "gain": 1.1})
LATE, SOON = (
    EffectUse("channel_skew", {"channel": OUTPUTS[2], "delay_s": sign * 0.002}) for sign in (1.0, -1.0)
)
ROWS = 300


@pytest.mark.parametrize(("effects", "more"), [((LAG,), 1), ((MOUNT,), 3), ((LAG, GAIN), 2)])
def test_a_name_costs_by_its_numbers(effects: tuple[EffectUse, ...], more: int) -> None:
    assert price(left(1.0, *effects)) - price(left(1.0)) == pytest.approx(more * PRICE)


@pytest.mark.parametrize(
    ("better", "worse"),
    [
        (left(300.0, LAG), left(301.0, LAG)),  # what is left decides
        (left(300.0, LAG), left(300.0 - 1.9 * PRICE, MOUNT)),  # fewer numbers, unless they pay
        (left(300.0 - 2.1 * PRICE, MOUNT), left(300.0, LAG)),
        (left(1.01 * FAR * ROWS, LAG), left(1.005 * FAR * ROWS, GAIN)),  # far off a sensor is doubted
        (left(300.0, LATE), left(299.0, SOON)),  # early is others late
        (left(300.0, SOON), left(303.0, LATE)),
        (left(300.0, GAIN), left(303.0, LAG)),  # near the noise it is not
    ],
)
def test_the_smaller_rank_is_preferred(better, worse) -> None:
    assert rank(better) < rank(worse)


def test_doubt_begins_far_from_the_noise() -> None:
    near, far = (left(share * FAR * ROWS, GAIN) for share in (0.99, 1.01))
    assert rank(near) == pytest.approx(near.total + price(near))
    assert rank(far) == pytest.approx(DOUBT * far.total + price(far))
