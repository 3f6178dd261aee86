"""Slippery roads in pictures: what slips is shown with its limit, and every line says whose it is."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hil.analysis.comparison import ComparedRun
from hil.core.recording import Recording
from hil.core.result import CriterionResult, RunResult, Segment
from reports.deciding_figure import deciding_figure
from reports.members import controller_of, members
from reports.overlay_figures import overlay_slip
from reports.sections import sections
from test_plans.metrics import WheelSlip

RADIUS_M = 0.3
ICE, BACK, DRY = (
    Segment(
        id=name,
        start_s=4.0 * k,
        step_s=4.0 * k + 1,
        end_s=4.0 * k + 4,
        controller="phase",
        controller_name="slip limit",
        initial_speed_km_h=20.0,
        reference_before=50.0,
        reference_after=after,
        quantity="driving_torque",
        rolling_radius_m=RADIUS_M,
        friction=friction,
    )
    for k, (name, after, friction) in enumerate(
        [("tip_in_ice", 300.0, 0.05), ("back_ice", -300.0, 0.05), ("tip_in_dry", 300.0, 1.0)]
    )
)
JUDGED = CriterionResult(
    id="tip_in_ice.own_name",
    value=0.25,
    unit="m/s",
    upper=0.4,
    verdict="pass",
    definition=WheelSlip().definition,
)
RESULT = RunResult(
    verdict="pass",
    plan="ice",
    bench="sim_road",
    real_time_factor=1.0,
    bench_time_s=12.0,
    safe_state="confirmed",
    segments=(ICE, BACK, DRY),
    criteria=(JUDGED,),
)


@pytest.fixture(scope="module")
def slipping() -> Recording:
    """V̂ of 5 m/s; after the first step the wheel runs 0.25 m/s ahead for half a second."""
    time = np.arange(12_000) / 1000.0
    slip = np.where((time > 1.2) & (time < 1.7), 0.25, 0.0)
    torque = np.sin(time)
    return Recording(
        {
            "time_s": time,
            "vehicle_speed_m_s": np.full(len(time), 5.0),
            "wheel_speed_rad_s": (5.0 + slip) / RADIUS_M,
            "motor_speed_rad_s": 8 * (5.0 + slip) / RADIUS_M,
            "shaft_torque_nm": torque,
            "driving_torque_ref_nm": np.select(
                [(time >= 1) & (time < 4), (time >= 5) & (time < 8), time >= 9], [300.0, -300.0, 300.0], 50.0
            ),
            "driving_torque_est_nm": torque,
        },
        Path("made.mcap"),
    )


def test_a_criterion_of_slip_shows_slip_limit_and_both_speeds(slipping: Recording) -> None:
    figure = deciding_figure(slipping, RESULT, JUDGED)
    assert figure is not None
    (trace,) = figure.traces
    assert (figure.y_unit, trace.label.plain()) == ("m/s", "Wheel slip, r ω_l - V̂")
    assert np.max(trace.y) == pytest.approx(0.25, abs=1e-9)
    assert sorted(level.value for level in figure.levels) == [-0.4, 0.4]
    (mark,) = figure.marks
    assert (mark.x, mark.y) == (pytest.approx(0.201), pytest.approx(0.25))
    assert "wheel 5.250" in figure.caption
    assert "vehicle 5.000" in figure.caption
    assert "Friction 0.05 of a dry road's." in figure.caption


def test_runs_with_slip_are_laid_over_each_other_with_the_limit(slipping: Recording) -> None:
    runs = tuple(ComparedRun(name, slipping, RESULT) for name in ("start", "tuned"))
    figure = overlay_slip(runs, ICE, "wheel_speed_rad_s", 0.4)
    assert figure is not None
    assert [trace.label.plain() for trace in figure.traces] == ["start", "tuned"]
    assert all(np.max(trace.y) == pytest.approx(0.25, abs=1e-9) for trace in figure.traces)
    assert [level.value for level in figure.levels] == [0.4, -0.4]
    unknown = ICE.model_copy(update={"rolling_radius_m": None})
    without = RESULT.model_copy(update={"segments": (unknown,)})
    assert overlay_slip((ComparedRun("start", slipping, without),), unknown, "wheel_speed_rad_s", 0.4) is None


def test_steps_of_one_controller_have_names_colours_and_roads_of_their_own(slipping: Recording) -> None:
    section = next(one for one in sections(slipping, RESULT) if one.title.startswith("Steps"))
    assert "Controller: slip limit." in section.text
    assert "tip_in_dry (dry road)" in section.text
    for figure in section.figures:
        drawn = [trace for trace in figure.traces if trace.role != "reference"]
        assert len({trace.role for trace in drawn}) == 3
        names = [trace.label.plain() for trace in drawn]
        assert [name.partition(",")[0] for name in names] == ["tip_in_ice", "back_ice", "tip_in_dry"]
        assert names[0].endswith("friction 0.05 of a dry road's")
        assert not any("Phase stabilization" in name for name in names)
        references = [trace.label.plain() for trace in figure.traces if trace.role == "reference"]
        assert len(set(references)) == len(references)


def test_repeats_of_one_step_share_a_colour_and_controllers_keep_theirs() -> None:
    again = ICE.model_copy(update={"id": "again"})
    one, two = members([ICE, again])
    assert one.role == two.role
    assert one.dash != two.dash
    assert (one.name.partition(",")[0], two.name.partition(",")[0]) == ("tip_in_ice", "again")
    lead = ICE.model_copy(update={"controller_name": "phase"})
    first, other, further = members([lead, ICE, again])
    assert (first.role, first.name.partition(",")[0]) == ("phase", "Phase stabilization")
    assert other.name.startswith("slip limit (tip_in_ice)")
    assert further.name.startswith("slip limit (again)")
    assert controller_of(ICE.model_copy(update={"controller_name": ""})) == "Phase stabilization"
