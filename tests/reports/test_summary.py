from __future__ import annotations

from pathlib import Path

import pytest
from lxml import html as lxml_html
from pypdf import PdfReader

from hil.core.recording import Recording
from hil.core.result import CriterionResult, RunResult
from reports import write_html
from reports.content import content
from reports.criteria import criteria_table
from reports.summary import MOST_ROWS, Summary, summary
from tests.reports import synthetic


def found(recording: Recording, result: RunResult) -> Summary:
    first = summary(recording, result, criteria_table(result))
    assert first is not None
    return first


def changed(result: RunResult, id_: str, **update: object) -> RunResult:
    criteria = [c.model_copy(update=update) if c.id == id_ else c for c in result.criteria]
    return result.model_copy(update={"criteria": tuple(criteria)})


def test_the_least_margin_comes_first_and_is_drawn_with_its_limit(
    recording: Recording, result: RunResult
) -> None:
    closer = changed(result, "phase_0kmh.peak_shaft_torque", upper=400.0)
    first = found(recording, closer)
    margins = [c.margin for c in closer.criteria if c.margin is not None]
    assert len(first.rows) == MOST_ROWS
    assert first.rows[0].margin == f"{100 * min(margins):.1f}\u202f%"
    assert first.further == "4 further criteria and device checks passed: see Criteria."
    assert first.figure is not None
    (level,) = first.figure.levels
    assert level.value == 400.0
    assert level.label.endswith("phase_0kmh")
    assert len(first.figure.marks) == 1
    assert "margin" in first.figure.caption


def test_what_is_not_met_comes_before_a_smaller_margin(recording: Recording, result: RunResult) -> None:
    failed = changed(result, "gain_20kmh.band_energy_motor_speed", upper=0.3, verdict="fail")
    first = found(recording, failed)
    assert (first.rows[0].id, first.rows[0].unmet) == ("gain_20kmh.band_energy_motor_speed", True)
    assert first.figure is not None
    assert first.figure.title.text.startswith("Not met: Band energy motor speed")
    assert first.figure.x_unit == "Hz"


def test_a_relative_criterion_is_drawn_with_its_rival(recording: Recording, result: RunResult) -> None:
    rival = CriterionResult(
        id="phase_20kmh.peak_shaft_torque.below.gain_20kmh",
        value=380.0,
        unit="N m",
        upper=381.0,
        below="gain_20kmh",
        verdict="pass",
        definition="Value of shaft_torque_nm (T_s) farthest in the step's direction.",
    )
    first = found(recording, result.model_copy(update={"criteria": (rival, *result.criteria)}))
    assert first.figure is not None
    assert [trace.role for trace in first.figure.traces] == ["phase", "gain"]
    assert [level.label for level in first.figure.levels] == ["Limit 381\u202fN\u202fm (gain_20kmh)"]


def test_without_limits_or_channels_there_is_nothing_to_decide(
    recording: Recording, result: RunResult
) -> None:
    free = [c.model_copy(update={"upper": None, "verdict": "informational"}) for c in result.criteria]
    without = result.model_copy(update={"criteria": tuple(free)})
    assert summary(recording, without, criteria_table(without)) is None
    empty = Recording({}, Path("empty.csv"))
    assert found(empty, result).figure is None


def test_the_first_screen_stands_before_the_particulars(acceptance: dict[str, Path]) -> None:
    document = lxml_html.fromstring(acceptance["html"].read_bytes().decode())
    order = [str(section.get("id")) for section in document.xpath("//main/section")]
    assert order[:3] == ["verdict", "summary", "criteria"]
    assert order.index("run") > order.index("overview")
    first = PdfReader(acceptance["pdf"]).pages[0].extract_text()
    assert "Criteria by margin" in first
    assert "Least margin" in first
    assert "Tested by" not in first
    assert "Tested by" in PdfReader(acceptance["pdf"]).pages[-1].extract_text()


@pytest.mark.parametrize("stated", [{}, {"customer": "Works 2"}])
def test_what_is_not_stated_is_said_once(tmp_path: Path, stated: dict[str, str]) -> None:
    recording, result = synthetic.recording(), synthetic.result()
    recording.metadata["report"] = stated
    facts = {fact.name: fact.value for fact in content(recording, result).laboratory}
    assert ("customer" in facts["Not stated"]) == (not stated)
    path = write_html(recording, result, tmp_path / "report.html")
    assert path.read_text(encoding="utf-8").lower().count("not stated") == 1
