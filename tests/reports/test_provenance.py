from __future__ import annotations

import hashlib
from pathlib import Path

from hil.core.recording import Recording
from hil.core.result import RunResult
from reports import provenance
from reports.content import content


def test_an_untouched_file_matches_and_a_changed_one_does_not(recording: Recording) -> None:
    recording.attachments["plan.yaml"] += b"# changed"
    del recording.attachments["bench.toml"]
    checks = {file.name: file.state for file in provenance.stored_files(recording)}
    assert checks == {
        "plan.yaml": "bad",
        "bench.toml": "bad",
        "controller/gain.toml": "good",
        "controller/phase.toml": "good",
    }


def test_calibration_is_judged_at_the_start_of_the_run(recording: Recording) -> None:
    left, right = provenance.calibration_facts(recording)
    assert (left.name, left.state) == ("Shaft torque left", "good")
    assert right.state == "bad"
    recording.metadata["run"]["started_at"] = "some day"
    assert [fact.state for fact in provenance.calibration_facts(recording)] == ["", ""]


def test_warnings_come_with_the_verdict(recording: Recording, result: RunResult) -> None:
    recording.attachments["plan.yaml"] = b"other"
    warnings = content(recording, result).warnings
    assert any("Shaft torque right" in text and "expired" in text for text in warnings)
    assert any(text.startswith("plan.yaml") for text in warnings)


def test_the_recordings_own_hash(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes(b"abc")
    assert provenance.recording_hash(Recording({}, path)) == hashlib.sha256(b"abc").hexdigest()
    assert provenance.recording_hash(Recording({}, tmp_path / "gone.csv")) == ""


def test_controllers_stand_side_by_side(recording: Recording) -> None:
    recording.attachments["controller/broken.toml"] = b"= not toml"
    table = provenance.controller_table(recording)
    assert table is not None
    assert table.names == ("gain", "phase")
    assert dict(table.rows)["wsc.lead.alpha"] == ("–", "0.2596")


def test_a_foreign_recording_says_how_long_it_is(recording: Recording) -> None:
    recording.metadata = {}
    facts = {fact.name: fact.value for fact in provenance.run_facts(recording, None)}
    assert facts["Samples"] == "96\u202f000"
    assert facts["Sample time"] == "0.001\u202fs"


def test_an_unconfirmed_safe_state_is_never_a_pass(recording: Recording, result: RunResult) -> None:
    unsafe = result.model_copy(update={"safe_state": "not_confirmed"})
    banner = content(recording, unsafe).banner
    assert banner.tone == "error"
    assert "did not confirm" in banner.alarm
    assert content(recording, result).banner.alarm == ""
