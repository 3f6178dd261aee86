"""`hil check`: what it prints, and what its exit code says."""

import json

import pytest

from hil.cli._app import guarded
from hil.engine.bench.ranges import limits_of_channels
from tests.benches_for_tests import SIM

PLAN = """
name: quick
steps:
  - set_controller: {file: phase_stabilization.toml}
  - hold_speed: {speed_km_h: 5, duration_s: 0.2}
  - step: {segment: s, quantity: driving_torque, from_nm: 0, to_nm: 200, before_s: 0.2, after_s: 1}
criteria:
  - {segment: s, metric: peak_shaft_torque, upper: LIMIT, unit: N m}
  - {segment: s, metric: overshoot_shaft_torque, unit: N m}
"""


@pytest.fixture
def check(tmp_path, capsys):
    """Exit code and standard output of `hil check` on a plan with a limit of the shaft's peak torque."""

    def execute(limit, *options):
        (tmp_path / "quick.yaml").write_text(PLAN.replace("LIMIT", str(limit)))
        code = guarded(["check", str(tmp_path / "quick.yaml"), *options])
        shown = capsys.readouterr()
        assert shown.err == ""
        return code, shown.out

    return execute


def test_peaks_stand_beside_limits_and_criteria_beside_theirs(check):
    code, text = check(400)
    assert code == 0
    lines = [line.split() for line in text.splitlines() if line.strip()]
    (peak,) = (line for line in lines if line[0] == "shaft_torque_left_nm")
    assert peak[2] == "600"
    (criterion,) = (line for line in lines if line[0] == "s.peak_shaft_torque")
    assert criterion[2:4] == ["≤", "400"]
    assert criterion[-1] == "pass"
    assert float(criterion[1]) == pytest.approx(2 * float(peak[1]), rel=0.01)
    assert lines[-1] == ["fits", "the", "bench"]


def test_a_criterion_predicted_to_fail_is_told_and_changes_no_exit_code(check):
    code, text = check(100)
    assert code == 0
    assert "fits the bench; 1 of 2 criteria are predicted to fail" in text


def test_json_has_the_criteria_with_their_verdicts(check):
    code, text = check(100, "--json")
    found = json.loads(text)
    assert (code, found["fits"], found["segments"]) == (0, True, ["s"])
    assert {name: peak["limit"] for name, peak in found["predicted"].items()} == limits_of_channels(
        SIM.limits
    )
    failed, informational = (one for one in found["criteria"] if one["source"] == "plan")
    assert (failed["id"], failed["verdict"], failed["upper"]) == ("s.peak_shaft_torque", "fail", 100.0)
    assert failed["margin"] == pytest.approx((100.0 - failed["value"]) / 100.0)
    assert (informational["verdict"], informational["margin"]) == ("informational", None)
    assert found["loops"]["phase_stabilization"]["stable"] is True


def test_a_peak_beyond_a_limit_is_exit_code_1(check, tmp_path):
    base = SIM.source.parent
    text = SIM.text.replace("shaft_torque_nm = 1200.0", "shaft_torque_nm = 150.0")
    for name in ("rmcu.dbc", "rcs_dyno.eds", "three_inertia.toml"):
        text = text.replace(f'"{name}"', f'"{base / name}"')
    (tmp_path / "low.toml").write_text(text)
    code, shown = check(400, "--bench", str(tmp_path / "low.toml"))
    assert code == 1
    assert "beyond the bench's limits" in shown
    code, shown = check(400, "--bench", str(tmp_path / "low.toml"), "--json")
    assert (code, json.loads(shown)["fits"]) == (1, False)


def test_the_controller_file_is_looked_at_before_anything_is_predicted(tmp_path, capsys):
    (tmp_path / "plan.yaml").write_text(PLAN.replace("phase_stabilization", "none"))
    assert guarded(["check", str(tmp_path / "plan.yaml")]) == 2
    assert "no such file" in capsys.readouterr().err


def test_driving_torque_on_held_wheels_is_no_loop_of_the_table(tmp_path, capsys):
    held = PLAN.replace("LIMIT", "400").replace("driving_torque,", "driving_torque, load: speed,")
    (tmp_path / "quick.yaml").write_text(held)
    guarded(["check", str(tmp_path / "quick.yaml")])
    assert "the dynos hold the speed (load: speed, segment 's')" in capsys.readouterr().err
