from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

from hil.core.recording import Recording
from hil.core.result import CriterionResult, RunResult
from reports import write_junit


def suite(recording: Recording, result: RunResult, directory: Path) -> ET.Element:
    found = ET.parse(write_junit(recording, result, directory / "junit.xml")).getroot().find("testsuite")
    assert found is not None
    return found


def case(of: ET.Element, name: str) -> ET.Element:
    (found,) = [c for c in of.iter("testcase") if c.get("name") == name]
    return found


def test_one_case_for_each_criterion_and_two_for_the_run(
    recording: Recording, result: RunResult, tmp_path: Path
) -> None:
    found = suite(recording, result, tmp_path)
    names = [f"{c.get('classname')}.{c.get('name')}" for c in found.iter("testcase")]
    assert names == [
        *(f"acceptance.{c.id}" for c in result.criteria),
        "acceptance.run",
        "acceptance.safe_state",
    ]
    assert (found.get("tests"), found.get("failures"), found.get("errors")) == ("18", "0", "0")


def test_failures_and_errors_carry_their_reason(
    recording: Recording, result: RunResult, tmp_path: Path
) -> None:
    criteria = (
        CriterionResult(id="a.low", value=1.0, unit="s", lower=2.0, verdict="fail", definition="How long."),
        CriterionResult(id="a.none", value=None, unit="s", verdict="error", reason="no samples"),
    )
    found = suite(recording, result.model_copy(update={"criteria": criteria}), tmp_path)
    failure = case(found, "low").find("failure")
    assert failure is not None
    assert "allowed is ≥" in failure.get("message", "")
    assert failure.text == "How long."
    error = case(found, "none").find("error")
    assert error is not None
    assert error.get("message") == "no samples"
    assert (found.get("failures"), found.get("errors")) == ("1", "1")


def test_an_unconfirmed_safe_state_is_an_error(
    recording: Recording, result: RunResult, tmp_path: Path
) -> None:
    unsafe = result.model_copy(update={"safe_state": "not_confirmed"})
    found = suite(recording, unsafe, tmp_path)
    assert case(found, "safe_state").find("error") is not None
    assert case(found, "run").find("error") is None


def test_a_broken_run_is_an_error_with_its_reason(
    recording: Recording, result: RunResult, tmp_path: Path
) -> None:
    broken = result.model_copy(update={"verdict": "error", "reason": "dyno left is silent", "criteria": ()})
    error = case(suite(recording, broken, tmp_path), "run").find("error")
    assert error is not None
    assert error.get("message") == "dyno left is silent"


def test_properties_name_bench_plan_and_versions(
    recording: Recording, result: RunResult, tmp_path: Path
) -> None:
    properties = {
        p.get("name"): p.get("value")
        for p in suite(recording, result, tmp_path).iterfind("properties/property")
    }
    assert properties["bench"] == "sim"
    assert properties["plan"] == "acceptance"
    assert properties["versions.git"] == "deadc42"


def test_what_xml_cannot_carry_is_replaced(hostile: dict[str, Path]) -> None:
    root = ET.parse(hostile["junit"]).getroot()
    assert "\ufffd" in root[0].get("name", "")
    assert "<script>" in root[0].get("name", "")


def test_what_counts_as_neither_is_skipped_and_what_never_settled_fails_its_limit(
    recording: Recording, result: RunResult, tmp_path: Path
) -> None:
    criteria = (
        CriterionResult(id="a.info", value=1.0, unit="s", verdict="informational"),
        CriterionResult(id="a.cut", value=None, unit="s", upper=1.0, verdict="not_judged", reason="stopped"),
        CriterionResult(id="a.rings", value=None, unit="s", verdict="did_not_settle", reason="outside"),
        CriterionResult(
            id="b.rings", value=None, unit="s", upper=5.0, verdict="did_not_settle", reason="out"
        ),
    )
    found = suite(recording, result.model_copy(update={"criteria": criteria}), tmp_path)
    assert (found.get("skipped"), found.get("failures"), found.get("errors")) == ("3", "1", "0")
    skipped = case(found, "cut").find("skipped")
    assert skipped is not None
    assert skipped.get("message") == "not judged: stopped"
    (failed,) = [c for c in found.iter("testcase") if c.find("failure") is not None]
    assert failed.get("classname") == "acceptance.b"


def test_a_case_carries_value_limits_unit_and_the_length_of_its_segment(
    recording: Recording, result: RunResult, tmp_path: Path
) -> None:
    criterion, segment = result.criteria[0], result.segments[0]
    found = next(suite(recording, result, tmp_path).iter("testcase"))
    told = {p.get("name"): p.get("value") for p in found.iterfind("properties/property")}
    assert float(told["value"] or "") == criterion.value
    assert float(told["upper_limit"] or "") == criterion.upper
    assert (told["unit"], told["verdict"]) == (criterion.unit, criterion.verdict)
    assert criterion.id.startswith(f"{segment.id}.")
    assert float(found.get("time", "")) == round(segment.end_s - segment.start_s, 3) > 0


def test_a_relative_criterion_is_of_its_own_segment(
    recording: Recording, result: RunResult, tmp_path: Path
) -> None:
    """Its id has three dots; what it is held against is a property."""
    criterion = CriterionResult(
        id="phase_0kmh.peak_shaft_torque.below.gain_0kmh",
        value=1.0,
        unit="N m",
        upper=2.0,
        below="gain_0kmh",
        verdict="pass",
    )
    found = suite(recording, result.model_copy(update={"criteria": (criterion,)}), tmp_path)
    (one,) = [c for c in found.iter("testcase") if c.get("classname") == "acceptance.phase_0kmh"]
    assert one.get("name") == "peak_shaft_torque.below.gain_0kmh"
    assert one.find("properties/property[@name='below']").get("value") == "gain_0kmh"
