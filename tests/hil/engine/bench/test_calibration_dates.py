"""A calibration that has run out is refused, or answered for by name and reason, which all outputs show."""

from __future__ import annotations

import datetime
import json
from pathlib import Path

import pytest

from hil.core.errors import BadInputError
from hil.core.recording import ACCEPTED_EXPIRY, read_recording, run_of
from hil.engine import RunRequest, run_plan
from hil.engine.bench.bench_channels import accepted_expiry
from reports import write_documents
from tests.benches_for_tests import SIM, plan, sim_bench

TODAY = datetime.date(2026, 3, 4)
DATES = {"shaft_torque": datetime.date(2026, 3, 3), "speed": datetime.date(2026, 3, 4)}
BENCH = SIM.model_copy(update={"calibration": DATES})
WHO = "A. Tester: laboratory closed until Monday"


def test_it_is_valid_on_its_last_day_and_refused_after() -> None:
    assert accepted_expiry(SIM, TODAY, "") is None
    assert accepted_expiry(SIM, TODAY, WHO) is None
    with pytest.raises(BadInputError, match=r"'shaft_torque' expired on 2026-03-03") as refused:
        accepted_expiry(BENCH, TODAY, "")
    assert "--accept-expired 'NAME: reason'" in str(refused.value)
    assert "'speed'" not in str(refused.value)
    accepted = accepted_expiry(BENCH, TODAY, "  A. Tester :by telephone: until Monday ")
    assert accepted is not None
    assert (accepted.by, accepted.reason) == ("A. Tester", "by telephone: until Monday")
    assert accepted.sensors == {"shaft_torque": "2026-03-03"}


@pytest.mark.parametrize("text", ["A. Tester", "A. Tester:", ": because", ":", " : "])
def test_a_name_and_a_reason_are_needed(text: str) -> None:
    with pytest.raises(BadInputError, match="lacks a name or a reason"):
        accepted_expiry(BENCH, TODAY, text)
    with pytest.raises(BadInputError, match="lacks a name or a reason"):
        accepted_expiry(SIM, TODAY, text)


def test_who_answered_stands_in_result_recording_and_report(tmp_path: Path) -> None:
    bench = sim_bench("expired", calibration={"shaft_torque": datetime.date(2020, 1, 1)})
    steps = "[{hold_speed: {speed_km_h: 2, duration_s: 0.1}}]"
    outcome = run_plan(RunRequest(plan(steps), bench, tmp_path, accept_expired=WHO))
    assert outcome.error is None
    stored = json.loads(outcome.result.model_dump_json())["accepted_expired"]
    assert stored == {
        "by": "A. Tester",
        "reason": "laboratory closed until Monday",
        "sensors": {"shaft_torque": "2020-01-01"},
    }
    recording = read_recording(outcome.recording)
    assert ACCEPTED_EXPIRY in recording.metadata
    del recording.attachments["run.json"]  # a recording that was cut tells it as well
    result = run_of(recording)
    assert result is not None
    assert result.accepted_expired == outcome.result.accepted_expired
    write_documents(recording, result, tmp_path)
    page = (tmp_path / "report.html").read_text()
    assert "expired before the run, accepted by A. Tester: laboratory closed until Monday" in page
