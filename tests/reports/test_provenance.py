from __future__ import annotations

import dataclasses
import hashlib
from pathlib import Path

from pypdf import PdfReader

from hil.core.recording import Recording
from hil.core.result import Lateness, PeriodicRequests, RunResult, Timing
from reports import provenance, write_reports
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


def test_calibration_is_judged_rising_of_the_run(recording: Recording) -> None:
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


def test_a_run_in_which_nothing_is_judged_is_not_green(recording: Recording, result: RunResult) -> None:
    free = {"upper": None, "lower": None, "below": "", "verdict": "informational"}
    informational = [criterion.model_copy(update=free) for criterion in result.criteria]
    banner = content(recording, result.model_copy(update={"criteria": tuple(informational)})).banner
    assert (banner.tone, banner.headline) == ("unjudged", "Executed, nothing judged")
    assert content(recording, result.model_copy(update={"criteria": ()})).banner.tone == "unjudged"


def test_the_banner_counts_what_was_demanded_and_says_why_the_rest_was_not_judged(
    recording: Recording, result: RunResult
) -> None:
    first, second, third, *rest = result.criteria
    criteria = (
        first.model_copy(
            update={"value": None, "verdict": "not_judged", "reason": "segment 'a' was stopped"}
        ),
        second.model_copy(update={"upper": None, "verdict": "informational"}),
        third.model_copy(
            update={"value": None, "upper": None, "verdict": "did_not_settle", "reason": "rings"}
        ),
        *rest,
    )
    stopped = result.model_copy(
        update={"criteria": criteria, "verdict": "error", "reason": "stopped by the operator"}
    )
    words = " ".join(content(recording, stopped).banner.sentences)
    assert words.startswith(f"Stopped by the operator. {len(rest)} of {len(rest) + 1} criteria passed. ")
    assert "1 not judged: segment 'a' was stopped. 1 informational. 1 response did not settle." in words


def test_damage_stands_in_the_report(recording: Recording, result: RunResult, tmp_path: Path) -> None:
    broken = dataclasses.replace(recording, damage=["samples from 1 s to 2 s are lost"])
    paths = write_reports(broken, result, tmp_path)
    assert "Damaged recording: samples from 1 s to 2 s are lost" in paths["html"].read_text()
    assert "Damaged recording" in PdfReader(paths["pdf"]).pages[0].extract_text()


def test_a_run_on_an_adapter_without_echoes_says_why_nothing_was_seen_on_the_bus(result: RunResult) -> None:
    late = Lateness(p50_ms=0.05, p99_ms=0.4, max_ms=2.25)
    request = PeriodicRequests(
        request="torque request", device="RMCU", period_s=0.001, count=5, missed=0, sent=late
    )
    timing = Timing(clock="wall", requests=(request,))
    (fact,) = provenance.timing_facts(result.model_copy(update={"timing": timing}))
    assert "on the bus not known: the adapter gives own frames not back, 0 cycles missed" in fact.value


def test_what_a_laboratory_says_and_what_it_does_not(recording: Recording, result: RunResult) -> None:
    recording.metadata["report"] = {"laboratory": "Test house, Street 1", "report_number": ""}
    told = {fact.name: fact.value for fact in provenance.laboratory_facts(recording, result)}
    assert told["Laboratory"] == "Test house, Street 1"
    assert told["Not stated"] == (
        "report number, customer, conditions, equipment, measurement uncertainty, decision rule"
    )
    assert "2026-11-30" in told["Calibration"]
    assert "simple acceptance" in told["Decision rule"]
    assert provenance.laboratory_facts(recording, None) == ()
