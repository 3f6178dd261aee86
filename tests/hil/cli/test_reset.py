"""A bench after an emergency stop, from one process to the next; a hazardous plan at the command line."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.benches_for_tests import SIM
from tests.hil.cli.test_commands import hil
from tests.hil.cli.test_sim_bench import serving

PLAN = "name: quick\nsteps: [{wait: {duration_s: 0.2}}]\n"
STOP = """
[interlocks.still]
channel = "motor_speed_rad_s"
unit = "rad/s"
above = 3.0
message = "keep it at rest"
response = "emergency_stop"
"""


@pytest.fixture
def bench(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("HIL_STATE", str(tmp_path / "state"))
    text = SIM.text + STOP
    for name in ("rmcu.dbc", "rcs_dyno.eds", "three_inertia.toml"):
        text = text.replace(f'"{name}"', f'"{SIM.source.parent / name}"')
    path = tmp_path / "bench.toml"
    path.write_text(text)
    return path


@pytest.mark.slow
def test_nobody_arms_the_bench_until_it_is_reset(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Not from another home either, nor by another file of the same ports."""
    monkeypatch.setenv("HIL_STATE", str(tmp_path / "state"))
    (tmp_path / "moving.yaml").write_text(
        "name: moving\nsteps: [{hold_speed: {speed_km_h: 5, duration_s: 1}}]\n"
    )
    (tmp_path / "quick.yaml").write_text(PLAN)
    with serving(tmp_path, "--time-scale", "0.2") as (_, served):
        bench, second = tmp_path / "bench.toml", tmp_path / "second.toml"
        bench.write_text(served.read_text() + STOP)
        options = "options = { receive_own_messages = true }"
        text = served.read_text().replace('name = "', 'name = "second_', 1)
        second.write_text(text.replace('interface = "hil-udp"', f'interface = "hil-udp"\n{options}'))
        done = hil(
            *("run", tmp_path / "moving.yaml", "--bench", bench, "--out", tmp_path / "a", "--json"), code=3
        )
        told = json.loads(done.stdout)
        assert told["emergency_stop"]["by"] == "interlock 'still'"
        assert told["emergency_stop"]["latched"]
        monkeypatch.setenv("HOME", str(tmp_path / "another"))
        again = hil("run", tmp_path / "quick.yaml", "--bench", second, "--out", tmp_path / "b", code=3)
        assert "emergency stop since" in again.stderr
        assert "hil bench reset" in again.stderr
        hil(
            "run", tmp_path / "quick.yaml", "--bench", "sim", "--out", tmp_path / "simulated"
        )  # another bench
        assert "--by is empty" in hil("bench", "reset", second, "--by", " ", code=2).stderr
        done = hil("bench", "reset", second, "--by", "A. Tester")
        assert done.stdout.startswith("reset by A. Tester: emergency stop of 20")
        assert "no emergency stop is latched" in hil("bench", "reset", second, "--by", "A. Tester").stdout
        hil("run", tmp_path / "quick.yaml", "--bench", second, "--out", tmp_path / "b")


@pytest.mark.slow
def test_a_simulated_bench_of_another_process_is_another_bench(bench: Path, tmp_path: Path) -> None:
    (tmp_path / "moving.yaml").write_text(
        "name: moving\nsteps: [{hold_speed: {speed_km_h: 5, duration_s: 1}}]\n"
    )
    for number in range(2):
        arguments = ("run", tmp_path / "moving.yaml", "--bench", bench, "--out", tmp_path / str(number))
        stopped = hil(*arguments, code=3)
        assert "emergency stop: motor_speed_rad_s reached" in stopped.stderr
        assert "its stop ends with the process" in stopped.stderr
    assert "its service keeps" in hil("bench", "reset", bench, "--by", "A. Tester").stdout


@pytest.mark.slow
def test_a_hazardous_plan_is_confirmed_by_name(bench: Path, tmp_path: Path) -> None:
    plan = tmp_path / "hazard.yaml"
    plan.write_text(PLAN + "hazardous: the wheels turn fast\n")
    refused = hil("run", plan, "--bench", bench, "--out", tmp_path / "a", code=2)
    assert "the plan is hazardous: the wheels turn fast" in refused.stderr
    hil("run", plan, "--bench", bench, "--out", tmp_path / "a", "--confirm", "A. Tester")
    assert "A. Tester" in (tmp_path / "a" / "report.html").read_text("utf-8")
