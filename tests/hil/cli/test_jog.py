"""`hil bench jog`: what it prints, writes and answers."""

import json

import pytest

from tests.benches_for_tests import SIM
from tests.hil.cli.test_commands import hil
from tests.hil.cli.test_sim_bench import MOST_REPEATS, serving


def test_signs_in_words_and_in_a_file(tmp_path):
    done = hil("bench", "jog", "sim", "--out", tmp_path / "jog")
    assert "every sign is right   safe state confirmed" in done.stdout
    told = json.loads((tmp_path / "jog" / "jog.json").read_text())
    assert (told["verdict"], told["findings"], told["safe_state"]) == ("right", [], "confirmed")
    assert (tmp_path / "jog" / "recording.mcap").exists()


@pytest.mark.slow
def test_a_wrong_sign_is_exit_code_1(tmp_path):
    for file in SIM.source.parent.iterdir():
        if file.suffix in (".toml", ".dbc", ".eds"):
            (tmp_path / file.name).write_bytes(file.read_bytes())
    bench = tmp_path / "sim.toml"
    bench.write_text(bench.read_text() + "\n[simulation.sensors]\nmotor_speed_rad_s = { gain = -1.0 }\n")
    done = hil("bench", "jog", bench, "--out", tmp_path / "jog", "--json", code=1)
    told = json.loads(done.stdout)
    assert told["verdict"] == "wrong"
    assert told["findings"][0]["what"].startswith("motor_speed_rad_s has the wrong sign")


def test_on_hardware_without_a_terminal_nothing_moves(tmp_path):
    text = hil("bench", "sim", "sim", "--port", "0", "--for", "0.1", "--json").stdout
    (tmp_path / "net.toml").write_text(json.loads(text)["bench_file"])
    done = hil("bench", "jog", tmp_path / "net.toml", "--out", tmp_path / "jog", code=2)
    assert "--yes 'YOUR NAME'" in done.stderr


@pytest.mark.slow
def test_a_hidden_wrong_sign_of_a_bench_in_another_process(tmp_path):
    """At a fifth of real time; a machine that stood still trips the RMCU, and then it is tried again."""
    hidden = ("--hide", "sensor_gain=-1", "sensor_gain.channel=shaft_torque_nm")
    for attempt in range(MOST_REPEATS):
        with serving(tmp_path, "--time-scale", "0.2", *hidden) as (_, file):
            out = tmp_path / str(attempt)
            arguments = ("bench", "jog", file, "--yes", "A. Tester", "--out", out, "--json")
            try:
                told = json.loads(hil(*arguments, code=1).stdout)
                break
            except AssertionError:
                if attempt == MOST_REPEATS - 1:
                    raise
    assert told["safe_state"] == "confirmed"
    wrong = {sign["channel"] for sign in told["signs"] if sign["verdict"] == "wrong"}
    assert wrong == {"shaft_torque_left_nm", "shaft_torque_right_nm"}
