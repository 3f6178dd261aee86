"""Numbers of a controller read, put back, and laid into the unit cube."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil.analysis.tuning import PARAMETERS, Space, values_of, with_values
from hil.analysis.tuning._parameters import TABLES, refuse_wide_margin
from hil.core.controller import load_controller
from hil.core.controller.shaping import RequestLimits
from hil.core.errors import BadInputError
from test_plans.loading import LIBRARY

PHASE = load_controller(LIBRARY / "controllers" / "phase_stabilization.toml")
CROSSING = load_controller(LIBRARY / "controllers" / "play_crossing.toml")
GAIN = load_controller(LIBRARY / "controllers" / "gain_stabilization.toml")


def test_the_papers_numbers_are_read():
    values = values_of(PHASE)
    assert values["lead_deg"] == pytest.approx(36.0, abs=1e-3)
    assert values["lead_hz"] == pytest.approx(40.0, abs=5e-3)
    assert values["pole_rad_s"] == pytest.approx(0.3, abs=1e-4)
    assert set(values) == set(PARAMETERS) - set(TABLES)
    limits = RequestLimits(rise_nm_s=1000.0, fall_nm_s=2000.0)
    assert set(values_of(CROSSING.model_copy(update={"request": limits}))) == set(PARAMETERS)


@given(
    st.fixed_dictionaries(
        {
            "lead_deg": st.floats(0.1, 80),
            "lead_hz": st.floats(1, 400),
            "pole_rad_s": st.floats(0.01, 10),
            "observer_time_s": st.floats(1e-3, 1),
            "slip_limit": st.floats(1e-3, 1),
        }
    )
)
def test_what_is_put_in_is_read_back(values):
    found = values_of(with_values(PHASE, values))
    assert {name: found[name] for name in values} == pytest.approx(values, rel=1e-9)


def test_numbers_of_a_table_are_put_in_and_read_back():
    values = {"crossing_speed_rad_s": 1.5, "landing_margin_rad": 0.001}
    found = with_values(CROSSING, values)
    assert {name: values_of(found)[name] for name in values} == values
    assert found.play.model_dump() == CROSSING.play.model_dump() | values


def test_a_table_that_is_not_there_is_refused():
    with pytest.raises(BadInputError, match=r"'phase' has no table \[play\]"):
        with_values(PHASE, {"crossing_speed_rad_s": 1.5})


def test_a_lead_takes_the_place_of_a_notch_and_the_other_way_round():
    lead = with_values(GAIN, {"lead_deg": 36.0, "lead_hz": 40.0}).wsc
    assert lead.notch is None
    assert lead.lead.alpha == pytest.approx(PHASE.wsc.lead.alpha, rel=1e-4)
    notch = with_values(PHASE, {"notch_hz": 10.6}).wsc
    assert (notch.lead, notch.notch) == (None, GAIN.wsc.notch)


def test_nothing_chosen_changes_nothing():
    assert with_values(PHASE, {}) == PHASE


@given(st.lists(st.floats(0, 1), min_size=2, max_size=2))
def test_points_and_values_are_each_others_inverse(point):
    space = Space({"lead_deg": (0.0, 75.0), "pole_rad_s": (0.05, 1.0)})
    np.testing.assert_allclose(space.point(space.values(np.array(point))), point, atol=1e-12)


def test_what_lies_outside_is_brought_to_the_border():
    space = Space({"lead_deg": (10.0, 20.0)})
    assert space.values(np.array([1.7])) == {"lead_deg": 20.0}
    assert space.point({"lead_deg": 3.0}) == 0.0


def test_a_margin_that_may_become_wider_than_the_gap_is_refused() -> None:
    wide = {"landing_margin_rad": (0.0, 0.05)}
    with pytest.raises(BadInputError, match=r"up to 0.05 it would be wider than the gap .* = 0.04"):
        refuse_wide_margin(CROSSING, wide, "free.toml")
    refuse_wide_margin(CROSSING, {"landing_margin_rad": (0.0, 0.04)}, "free.toml")
    refuse_wide_margin(CROSSING, {"lead_hz": (20.0, 60.0)}, "free.toml")
