"""The verdicts as JUnit XML, which every CI server reads."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from pathlib import Path

from hil.core.files import write_atomically
from hil.core.recording import Recording
from hil.core.result import CriterionResult, RunResult
from reports.criteria import in_words

#: What XML 1.0 cannot carry at all.
_FORBIDDEN = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_PROPERTY_TABLES = ("run", "dut", "versions")


def write_junit(recording: Recording, result: RunResult, path: Path) -> Path:
    """Write the verdicts as JUnit XML, whole or not at all.

    Raises:
        BadInputError: `path` cannot be written.
    """
    write_atomically(path, junit_text(recording, result))
    return path


def junit_text(recording: Recording, result: RunResult) -> bytes:
    """One test case for each criterion, one for the run itself and one for the bench's safe state.

    A criterion's class is its segment, its time the length of that segment on the bench; value, limits,
    unit and margin are its properties.
    """
    suite = ET.Element("testsuite", name=_clean(result.plan))
    _properties(suite, recording, result)
    lengths = {segment.id: segment.end_s - segment.start_s for segment in result.segments}
    for criterion in result.criteria:
        _criterion(suite, criterion, result.plan, lengths)
    run = _case(suite, result.plan, "run", result.bench_time_s)
    if result.verdict == "error":
        _outcome(run, "error", result.reason or "the run did not come to its end")
    safe = _case(suite, result.plan, "safe_state")
    if result.safe_state == "not_confirmed":
        _outcome(safe, "error", "the bench did not confirm its safe state after the run")
    counts = {
        "tests": len(suite.findall("testcase")),
        "failures": len(suite.findall("testcase/failure")),
        "errors": len(suite.findall("testcase/error")),
        "skipped": len(suite.findall("testcase/skipped")),
    }
    for element in (suite, root := ET.Element("testsuites")):
        for name, count in counts.items():
            if element is suite or name != "skipped":  # `testsuites` has no such attribute
                element.set(name, str(count))
        element.set("time", f"{result.bench_time_s:.3f}")
    started = recording.metadata.get("run", {}).get("started_at")
    if started:
        suite.set("timestamp", _clean(started))
    root.append(suite)
    ET.indent(root)
    return bytes(ET.tostring(root, encoding="utf-8", xml_declaration=True)) + b"\n"


def _properties(suite: ET.Element, recording: Recording, result: RunResult) -> None:
    values = {
        "plan": result.plan,
        "bench": result.bench,
        "verdict": result.verdict,
        "safe_state": result.safe_state,
        "real_time_factor": f"{result.real_time_factor:g}",
    }
    for table in _PROPERTY_TABLES:
        values |= {f"{table}.{key}": text for key, text in recording.metadata.get(table, {}).items()}
    _list(suite, values)


def _criterion(suite: ET.Element, criterion: CriterionResult, plan: str, lengths: dict[str, float]) -> None:
    segment, _, metric = criterion.id.partition(".")
    if metric:
        case = _case(suite, f"{plan}.{segment}", metric, lengths.get(segment, 0.0))
    else:
        case = _case(suite, plan, criterion.id)
    _list(case, _figures(criterion))
    if criterion.failed:
        _outcome(case, "failure", in_words(criterion), criterion.definition)
    elif criterion.verdict == "error":
        _outcome(case, "error", in_words(criterion), criterion.definition)
    elif criterion.verdict != "pass":  # counts as neither: the nearest that JUnit has is a skipped test
        reason = f"{criterion.verdict.replace('_', ' ')}: {in_words(criterion)}"
        ET.SubElement(case, "skipped", message=_clean(reason))


def _figures(criterion: CriterionResult) -> dict[str, str]:
    """What was found and what was allowed, as in `result.json`; nothing of what there is not."""
    numbers = {
        "value": criterion.value,
        "lower_limit": criterion.lower,
        "upper_limit": criterion.upper,
        "margin": criterion.margin,
    }
    shown = {name: repr(value) for name, value in numbers.items() if value is not None}
    words = {"unit": criterion.unit, "below": criterion.below, "definition": criterion.definition}
    return {**shown, **{name: text for name, text in words.items() if text}, "verdict": criterion.verdict}


def _case(suite: ET.Element, classname: str, name: str, time_s: float = 0.0) -> ET.Element:
    return ET.SubElement(
        suite, "testcase", classname=_clean(classname), name=_clean(name), time=f"{time_s:.3f}"
    )


def _list(of: ET.Element, values: dict[str, str]) -> None:
    properties = ET.SubElement(of, "properties")
    for name, value in values.items():
        ET.SubElement(properties, "property", name=_clean(name), value=_clean(value))


def _outcome(case: ET.Element, kind: str, message: str, text: str = "") -> None:
    ET.SubElement(case, kind, message=_clean(message), type=kind).text = _clean(text) or None


def _clean(text: str) -> str:
    return _FORBIDDEN.sub("\ufffd", text)
