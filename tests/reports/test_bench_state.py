"""Which software the devices ran, in the report."""

from pathlib import Path

from hil.core.recording import Recording
from hil.core.result import Identity, RunResult, Zero
from reports.bench_state import identification_facts, zero_facts
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


def test_sensors_at_rest(recording: Recording, result: RunResult) -> None:
    zeros = (
        Zero(channel="shaft_torque_left_nm", unit="N m", before=1.0, after=3.5, within=5.0, drift_within=2.0),
        Zero(channel="motor_speed_rad_s", unit="rad/s", before=0.01, reason="the axle turns"),
    )
    left, speed = zero_facts(result.model_copy(update={"zeros": zeros}))
    assert left.state == "bad"
    assert "limit 5 N m" in left.value
    assert "no limit stated" in speed.value
    assert "not read after: the axle turns" in speed.value
    assert speed.state == ""
    assert zero_facts(None) == ()


def test_a_recording_alone_tells_them_too(tmp_path: Path) -> None:
    said = {"rmcu: software": "2.4.0", "dyno: rear left: serial": "7"}
    alone = Recording({}, tmp_path / "a.mcap", metadata={"identification": said})
    assert [(fact.name, fact.value) for fact in identification_facts(alone, None)] == [
        ("rmcu", "software 2.4.0"),
        ("dyno, rear left", "serial 7"),
    ]
