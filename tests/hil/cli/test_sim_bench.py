"""`hil bench sim` in a process of its own, and `hil run` in another that drives it as hardware."""

from __future__ import annotations

import contextlib
import json
import signal
import subprocess
import time
import tomllib

import pytest

from tests.hil.cli.test_commands import HIL, QUICK, hil

MOST_REPEATS = 4


@contextlib.contextmanager
def serving(tmp_path, *options):
    """A served bench: its process, and the bench file that connects to it."""
    file = tmp_path / "net.toml"
    file.unlink(missing_ok=True)
    command = [HIL, "bench", "sim", "sim", "--port", "0", "--bench-file", file, *options]
    process = subprocess.Popen(
        list(map(str, command)), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    try:
        for _ in range(2400):
            if file.exists() or process.poll() is not None:
                break
            time.sleep(0.05)
        else:
            process.kill()  # else it would be waited for
        assert file.exists(), process.communicate()
        yield process, file
    finally:
        process.kill()
        process.communicate()


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_cleanly_and_it_says_how_it_went(number, tmp_path):
    with serving(tmp_path) as (process, file):
        process.send_signal(number)
        out, err = process.communicate(timeout=30)
    assert process.returncode == 130
    assert "Traceback" not in err
    assert err.startswith("served ")
    assert "frames sent" in err
    assert tomllib.loads(out) == tomllib.loads(file.read_text())
    assert out.startswith("# The simulated bench 'sim' in real time")


def test_it_ends_by_itself_and_tells_programs_what_it_serves():
    done = hil("bench", "sim", "sim", "--port", "0", "--for", "0.2", "--hide", "backlash=0.01", "--json")
    told = json.loads(done.stdout)
    assert told["buses"]["rmcu"]["interface"] == "hil-udp"
    assert told["hidden"][0].startswith("backlash: ")
    assert "backlash" not in told["bench_file"]  # it is hidden


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("sim", "--transport", "pigeon"), "--transport 'pigeon' is not known"),
        (("sim", "--hide", "backlsh=1"), "there is no effect 'backlsh'"),
        (("sim", "--hide", "backlash"), "--hide: 'backlash' has no '='"),
        (("rear_axle_socketcan",), "it is a bench with hardware"),
    ],
)
def test_bad_input_is_one_message(arguments, said):
    assert said in hil("bench", "sim", *arguments, code=2).stderr


@pytest.mark.slow
def test_a_run_in_another_process_drives_it_as_hardware(tmp_path):
    """At a fifth of real time; a machine that stood still trips the RMCU, and then it is tried again."""
    (tmp_path / "quick.yaml").write_text(QUICK.replace("LIMIT", "400"))
    virtual = json.loads(hil("run", tmp_path / "quick.yaml", "--out", tmp_path / "v", "--json").stdout)
    for attempt in range(MOST_REPEATS):
        with serving(tmp_path, "--time-scale", "0.2") as (_, file):
            command = [HIL, "run", "quick.yaml", "--bench", file, "--out", str(attempt), "--json"]
            done = subprocess.run(command, capture_output=True, text=True, timeout=300, cwd=tmp_path)
            assert "Traceback" not in done.stderr
            if done.returncode != 3:
                break
    assert done.returncode == 0, done.stderr
    result = json.loads(done.stdout)
    assert (result["verdict"], result["safe_state"]) == ("pass", "confirmed")
    peaks = [run["criteria"][0]["value"] for run in (result, virtual)]
    assert peaks[0] == pytest.approx(peaks[1], rel=0.02)
