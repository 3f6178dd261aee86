"""Tip-in and tip-out in the report: what is marked is where the metrics find it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hil.core.recording import Recording
from hil.core.result import CriterionResult, Segment
from reports.drive_figures import drive_figure, drive_section
from reports.plotly_figure import plotly_figure
from reports.svg_figure import svg_figure
from test_plans.metrics import Clunk, Jerk, TimeInPlay

TIME = np.arange(20_001) / 1000
STEPS = (("tip_in", 1.0, -150.0, 300.0), ("tip_out", 6.0, 300.0, -150.0), ("again", 11.0, -150.0, 300.0))


def segment(name: str, step_s: float, before: float, after: float, speed: float = 20.0) -> Segment:
    return Segment(
        id=name, start_s=step_s - 1.0, step_s=step_s, end_s=step_s + 4.0, initial_speed_km_h=speed,
        reference_before=before, reference_after=after, quantity="driving_torque", gear_ratio=8.0,
    )  # fmt: skip


def recorded() -> tuple[Recording, list[Segment]]:
    """T_s that waits at zero for 30 ms on its way, and a speed that follows it."""
    torque = np.full(len(TIME), -150.0)
    asked = torque.copy()
    segments = []
    for name, step_s, before, after in STEPS:
        segments.append(segment(name, step_s, before, after))
        way = np.interp(TIME - step_s, [0.0, 0.05, 0.08, 0.1, 0.2], [before, 0.0, 0.0, after, after])
        torque = np.where(step_s <= TIME, way, torque)
        asked = np.where(step_s <= TIME, after, asked)
    speed = 5.0 + np.cumsum(torque) * 1e-3 / 900.0
    still = 20.0 + 0.0 * TIME
    channels = {
        "time_s": TIME, "shaft_torque_nm": torque, "driving_torque_ref_nm": asked, "vehicle_speed_m_s": speed,
        "motor_speed_rad_s": 8.0 * still + 0.01 * torque, "wheel_speed_rad_s": still,
    }  # fmt: skip
    return Recording(channels, Path("made.mcap")), segments


def criteria(*names: str) -> dict[str, CriterionResult]:
    return {name: CriterionResult(id=name, value=1.0, unit="1", verdict="pass") for name in names}


ASKED = criteria("tip_in.jerk", "tip_out.clunk", "again.time_in_play")


def test_upwards_stands_beside_downwards_and_what_has_no_counterpart_at_the_end() -> None:
    recording, segments = recorded()
    other = segment("other", 11.0, -150.0, 300.0, speed=50.0)
    section = drive_section(recording, [*segments, other], ASKED | criteria("other.jerk"))
    assert section is not None
    assert [one.id for one in section.figures] == [
        "drive-tip_in",
        "drive-tip_out",
        "drive-again",
        "drive-other",
    ]
    assert section.notes == ()


def test_play_contact_and_jerk_are_marked_where_the_metrics_find_them() -> None:
    recording, segments = recorded()
    for one in segments:
        figure = drive_figure(recording, one)
        assert figure is not None
        (band,) = figure.bands
        assert band.end - band.start == pytest.approx(TimeInPlay().compute(recording, one))
        contact, jerk = figure.marks
        assert contact.x == pytest.approx(band.end)
        assert abs(contact.y) == pytest.approx(45.0, rel=1e-6)
        rate = Clunk().compute(recording, one)
        assert rate == pytest.approx(abs(one.reference_after) / 0.02, rel=1e-9)
        assert "clunk" in contact.label
        late_s, value = Jerk().largest(recording, one)
        assert jerk.x == pytest.approx(late_s)
        assert f"{abs(value):.3g}" in jerk.label
        assert contact.label in figure.caption


def test_of_several_passages_the_longest_has_its_length_beside_it() -> None:
    recording, segments = recorded()
    torque = recording["shaft_torque_nm"] + np.where(
        (TIME > 1.3) & (TIME < 1.5), -600.0 * np.sin(np.pi * (TIME - 1.3) / 0.2), 0.0
    )
    figure = drive_figure(
        Recording({**recording.channels, "shaft_torque_nm": torque}, Path("made.mcap")), segments[0]
    )
    assert figure is not None
    assert len(figure.bands) == 3
    assert [bool(band.label) for band in figure.bands] == [True, False, False]
    annotations = plotly_figure(figure)["layout"]["annotations"]
    assert [one["text"] for one in annotations] == [figure.bands[0].label]
    assert svg_figure(figure).count(b"<svg") == 1


def test_a_number_that_a_criterion_has_is_that_of_the_criterion() -> None:
    recording, segments = recorded()
    known = {
        f"tip_in.{name}": CriterionResult(id=f"tip_in.{name}", value=value, unit="", verdict="pass")
        for name, value in (("jerk", 4.321), ("clunk", 1234.0), ("contact_energy", 5.678))
    }
    figure = drive_figure(recording, segments[0], known)
    assert figure is not None
    assert all(number in figure.caption for number in ("4.32", "1234", "5.68"))


def test_a_plan_that_asks_for_none_of_it_has_no_such_section() -> None:
    recording, segments = recorded()
    assert drive_section(recording, segments, criteria("tip_in.peak_shaft_torque")) is None
    assert drive_section(recording, [], ASKED) is None


def test_without_speeds_the_torque_is_drawn_all_the_same() -> None:
    recording, segments = recorded()
    names = ("time_s", "shaft_torque_nm")
    torque = Recording({name: recording[name] for name in names}, Path("made.mcap"))
    figure = drive_figure(torque, segments[0])
    assert figure is not None
    assert [mark.label.split(",")[0] for mark in figure.marks] == ["contact"]
    assert drive_figure(Recording({"time_s": TIME}, Path("made.mcap")), segments[0]) is None
