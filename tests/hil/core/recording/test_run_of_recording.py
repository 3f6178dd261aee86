"""What a recording tells of its run, whole or cut off."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from hil.core.errors import BadInputError
from hil.core.recording import RUN, SEGMENT, Recording, driven_by_torque, run_of
from hil.core.result import RunResult, Segment

TIME = np.arange(10_001) / 1000
ENDED = Segment(id="a", start_s=1.0, step_s=1.5, end_s=4.0)
OPEN = Segment(id="b", start_s=6.0, step_s=7.0, end_s=20.0, complete=False)
NEVER = Segment(id="c", start_s=30.0, step_s=31.0, end_s=40.0, complete=False)


def recording(attachments: dict[str, bytes], *segments: Segment) -> Recording:
    channels = {name: np.zeros(len(TIME)) for name in ("motor_torque_ref_nm", "wheel_speed_rad_s")}
    metadata = {SEGMENT + s.id: {"json": s.model_dump_json()} for s in segments}
    run = {"run": {"plan": "p", "bench": "b"}}
    return Recording({"time_s": TIME, **channels}, Path("r.mcap"), metadata | run, attachments)


def test_a_foreign_recording_has_no_run() -> None:
    assert run_of(Recording({"time_s": TIME}, Path("r.csv"))) is None


def test_the_stored_result_counts() -> None:
    stored = RunResult(
        verdict="pass", plan="p", bench="b", real_time_factor=1, bench_time_s=1, safe_state="confirmed"
    )
    assert run_of(recording({RUN: stored.model_dump_json().encode()}, OPEN)) == stored


def test_a_cut_recording_has_its_segments_as_far_as_they_were_recorded() -> None:
    found = run_of(recording({"plan.yaml": b""}, ENDED, OPEN, NEVER))
    assert found is not None
    assert found.segments == (ENDED, OPEN.model_copy(update={"end_s": 10.0}))
    assert (found.verdict, found.safe_state) == ("error", "not_confirmed")


def test_what_the_dynos_did_in_between_is_no_part_of_a_cut_recording_either() -> None:
    parts = driven_by_torque(recording({"plan.yaml": b""}, ENDED, OPEN))
    assert [(part.time_s[0], part.time_s[-1]) for part in parts] == [(1.0, 4.0), (6.0, 10.0)]


@pytest.mark.parametrize("broken", [b"", b"{", b"[]", json.dumps({"verdict": "pass"}).encode(), b"\xff"])
def test_a_broken_result_is_said(broken: bytes) -> None:
    with pytest.raises(BadInputError, match="damaged"):
        run_of(recording({RUN: broken}))
    table = {SEGMENT + "a": {"json": broken.decode(errors="replace")}, "run": {"plan": "p"}}
    cut = recording({"plan.yaml": b""})
    cut.metadata = table
    with pytest.raises(BadInputError, match="damaged"):
        run_of(cut)
