"""Which software the devices ran, in the report."""

from pathlib import Path

from hil.core.recording import Recording
from hil.core.result import Identity, RunResult
from reports.bench_state import identification_facts
from reports.content import content

SAID = (
    Identity(device="rmcu", name="software", value="2.4.0", expected="2.4.1"),
    Identity(device="rmcu", name="calibration", value="00FF"),
    Identity(device="dyno", name="rear left: software", value="1.0", expected="1.0"),
    Identity(device="dyno", name="rear right: software", value="1.0"),
)


def test_a_line_for_each_part_and_what_is_wrong_in_it(recording: Recording, result: RunResult) -> None:
    named = result.model_copy(update={"identities": SAID})
    assert [(fact.name, fact.value, fact.state) for fact in identification_facts(recording, named)] == [
        ("rmcu", "software 2.4.0 (2.4.1 was expected), calibration 00FF", "bad"),
        ("dyno, rear left", "software 1.0", "good"),
        ("dyno, rear right", "software 1.0", ""),
    ]
    assert any("2.4.1 was expected" in warning for warning in content(recording, named).warnings)


def test_a_recording_alone_tells_them_too(tmp_path: Path) -> None:
    said = {"rmcu: software": "2.4.0", "dyno: rear left: serial": "7"}
    alone = Recording({}, tmp_path / "a.mcap", metadata={"identification": said})
    assert [(fact.name, fact.value) for fact in identification_facts(alone, None)] == [
        ("rmcu", "software 2.4.0"),
        ("dyno, rear left", "serial 7"),
    ]
