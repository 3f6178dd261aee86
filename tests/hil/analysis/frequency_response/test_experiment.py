from __future__ import annotations

import numpy as np
import pytest

from hil.analysis.frequency_response import experiments_of
from hil.core.errors import BadInputError
from hil.core.recording import Recording
from hil.core.result import RunResult, Segment
from tests.hil.analysis import paper_plant


def run_recording(*kinds: str) -> Recording:
    """A recording of 10 s segments of these kinds."""
    recording = paper_plant.recording(paper_plant.chirp(10.0 * len(kinds)))
    segments = tuple(
        Segment(id=f"s{i}", kind=kind, start_s=10.0 * i, step_s=10.0 * i, end_s=10.0 * (i + 1) - 0.001)
        for i, kind in enumerate(kinds)
    )
    result = RunResult(
        verdict="pass",
        plan="p",
        bench="sim",
        real_time_factor=1,
        bench_time_s=30,
        safe_state="confirmed",
        segments=segments,
    )
    recording.attachments["run.json"] = result.model_dump_json().encode()
    return recording


def test_exciting_segments_are_the_default() -> None:
    found = experiments_of(run_recording("chirp", "step", "multisine"))
    assert [e.kind for e in found] == ["chirp", "multisine"]
    assert [len(e.input) for e in found] == [10_000, 10_000]
    assert found[1].name.endswith("segment s2")


def test_segments_can_be_chosen() -> None:
    found = experiments_of(run_recording("chirp", "step"), segments=["s1"])
    assert [e.kind for e in found] == ["step"]


def test_unknown_segment_names_the_known() -> None:
    with pytest.raises(BadInputError, match="no segment 'x'") as caught:
        experiments_of(run_recording("chirp"), segments=["x"])
    assert "s0" in caught.value.fix


def test_run_without_excitation_is_refused() -> None:
    with pytest.raises(BadInputError, match="none of its segments is a chirp"):
        experiments_of(run_recording("step"))


def test_broken_run_is_refused() -> None:
    recording = run_recording("chirp")
    recording.attachments["run.json"] = b"{"
    with pytest.raises(BadInputError, match=r"run\.json"):
        experiments_of(recording)


def test_other_recordings_are_one_experiment() -> None:
    recording = paper_plant.recording(paper_plant.chirp(10.0))
    del recording.channels["wheel_speed_rad_s"]
    (one,) = experiments_of(recording)
    assert one.output_names == ("motor_speed_rad_s", "shaft_torque_nm")
    assert one.hold_s == pytest.approx(0.001)
    assert one.reference is None


def test_rounded_time_stamps_are_even() -> None:
    recording = paper_plant.recording(paper_plant.chirp(10.0))
    recording.channels["time_s"] = np.round(recording.time_s + 1e-6 * np.sin(np.arange(10_000)), 6)
    assert experiments_of(recording)[0].notes == ()


def test_an_angle_is_read_by_its_slope() -> None:
    recording = run_recording("chirp")
    time = recording.time_s
    speed = 3.0 + 20.0 * np.cos(2.0 * np.pi * 10.0 * time)
    angle = 3.0 * time + np.sin(2.0 * np.pi * 10.0 * time) / np.pi
    recording.channels["wheel_angle_rad"] = angle % (2.0 * np.pi)
    del recording.channels["wheel_speed_rad_s"]
    (found,) = experiments_of(recording)
    row = found.outputs[found.output_names.index("wheel_speed_rad_s")]
    assert row[20:-20] == pytest.approx(speed[20:-20], abs=1e-3)
    assert "wheel_speed_rad_s is the slope of wheel_angle_rad" in found.notes
