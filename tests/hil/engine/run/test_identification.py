"""What devices say that they are, against what the bench file expects."""

import pytest

from drivers import RmcuTable
from hil.core.errors import BenchError
from hil.core.recording import read_recording
from hil.core.result import RunResult
from hil.engine import RunRequest, run_plan
from hil.engine.commissioning.doctor import DoctorRequest, examine_bench
from hil.engine.run.arming import identities_of, refuse_others
from tests.benches_for_tests import SIM, plan, running, sim_bench

PLAN = plan("[{wait: {duration_s: 0.1}}]")


class Talkative:
    def identify(self):
        return {"left: software": "1.2", "right: software": "1.3", "calibration": "00FF"}


def table(**expects):
    return RmcuTable(kind="rmcu-can", bus="rmcu", dbc=SIM.rmcu.dbc, expects=expects)


def matches(**expects):
    return {i.name: i.matches for i in identities_of("rmcu", table(**expects), Talkative())}


def test_a_name_counts_for_the_device_and_for_each_part():
    assert matches() == {"left: software": True, "right: software": True, "calibration": True}
    assert matches(software="1.2") == {"left: software": True, "right: software": False, "calibration": True}
    assert matches(**{"right: software": "1.3"})["right: software"]
    assert not matches(**{"right: software": "1.2"})["right: software"]


def test_what_is_expected_and_not_said_does_not_match():
    assert not matches(serial="7")["serial"]
    assert not identities_of("rmcu", table(software="1"), object())[0].matches


def test_the_devices_of_the_simulated_bench():
    with running() as bench:
        rmcu, dyno = bench.rmcu.identify(), bench.dyno.identify()
    assert rmcu == {"software": "1.0.0", "hardware": "1", "calibration": "0DA2024A"}
    assert dyno["rear left: software"] == "1.0.0"
    assert dyno["front right: serial"] == "1002"
    assert dyno["rear right: product"] == "0x00000001"


def test_other_software_is_refused_before_anything_is_armed(tmp_path):
    expecting = SIM.rmcu.model_copy(update={"expects": {"software": "2.4.1"}})
    outcome = run_plan(RunRequest(PLAN, sim_bench(rmcu=expecting), tmp_path))
    assert isinstance(outcome.error, BenchError)
    assert outcome.error.what == "rmcu: software is 1.0.0, the bench file expects 2.4.1"
    assert (outcome.result.verdict, outcome.result.safe_state) == ("error", "not_needed")
    assert not outcome.result.identities[0].matches


def test_the_doctor_tells_other_software():
    expecting = SIM.rmcu.model_copy(update={"expects": {"software": "2.4.1", "hardware": "1"}})
    found = examine_bench(DoctorRequest(sim_bench(rmcu=expecting), 0.3))
    (finding,) = found.findings
    assert finding.what == "software is 1.0.0, the bench file expects 2.4.1"
    assert "[rmcu.expects]" in finding.fix
    assert found.devices["rmcu"].facts["hardware"] == "1"


def test_what_they_say_stands_in_result_and_recording(tmp_path):
    expecting = SIM.dyno.model_copy(update={"expects": {"software": "1.0.0"}})
    outcome = run_plan(RunRequest(PLAN, sim_bench(dyno=expecting), tmp_path))
    assert outcome.error is None
    said = {(i.device, i.name): i.value for i in outcome.result.identities}
    assert said["rmcu", "calibration"] == "0DA2024A"
    recording = read_recording(outcome.recording)
    assert recording.metadata["identification"]["dyno: rear left: serial"] == "1003"
    assert (
        RunResult.model_validate_json(recording.attachments["run.json"]).identities
        == outcome.result.identities
    )


def test_nobody_is_refused_for_nothing():
    refuse_others(identities_of("rmcu", table(calibration="00FF"), Talkative()))
    with pytest.raises(BenchError, match="calibration is 00FF, the bench file expects 0100"):
        refuse_others(identities_of("rmcu", table(calibration="0100"), Talkative()))


def test_an_rmcu_whose_dbc_has_no_identification_says_nothing(tmp_path):
    text = SIM.rmcu.dbc.read_text()
    start, end = text.index("BO_ 274"), text.index("BO_ 288")
    kept = text[:start] + text[end:]
    lines = [line for line in kept.splitlines() if " 274 " not in line]
    (tmp_path / "rmcu.dbc").write_text("\n".join(lines) + "\n")
    without = SIM.rmcu.model_copy(update={"dbc": tmp_path / "rmcu.dbc"})
    with running(rmcu=without) as bench:
        assert bench.rmcu.identify() == {}
