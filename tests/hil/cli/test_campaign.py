"""`hil campaign`: what it writes and says, what it refuses, what Ctrl-C and kills leave."""

import contextlib
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pandas as pd
import pytest

from hil.cli._app import guarded
from tests.hil.campaign.short import CAMPAIGN, written
from tests.hil.cli.test_commands import HIL

#: Some ten seconds of one processor, in eight part files or more.
LONG = """
name: long
plan: short.yaml
draws: 1500
seed: 3
tolerance: {tyre_stiffness: 0.2, sensor_noise: 1}
"""


def campaign(*arguments):
    return guarded(["campaign", *map(str, arguments)])


def table_of(out):
    return pd.read_parquet(out / "simulations").sort_values("simulation", ignore_index=True)


@pytest.mark.slow
def test_what_it_writes_and_says_and_goes_on_with(tmp_path, capsys):
    file, out = written(tmp_path, CAMPAIGN + "pass_share: 0.5\n"), tmp_path / "out"
    assert campaign(file, "--workers", 0, "--out", out) == 0
    said = capsys.readouterr().out
    told = json.loads((out / "campaign.json").read_text())
    assert {path.name for path in out.iterdir()} == {*told["files"], told["table"]}
    assert told["simulations"] == len(table_of(out)) == 16
    assert [one["controller"] for one in told["controllers"]] == ["phase_stabilization", "gain_stabilization"]
    share = told["controllers"][0]["share"]
    assert share["interval"][0] < share["share"] <= share["interval"][1]
    assert told["passed"] is True
    assert "required pass rate 50 %: reached" in said
    assert "phase_stabilization: 8 of 8 (100.0 %; 63.1 to 100.0 %) pass" in said
    assert (out / "report.pdf").read_bytes().startswith(b"%PDF")
    assert "What the criteria depend on" in (out / "report.html").read_text()

    assert campaign(file, "--workers", 0, "--out", out) == 2
    assert "--overwrite" in capsys.readouterr().err
    first = sorted((out / "simulations").iterdir())
    kept = first[1].stat().st_mtime_ns
    first[0].unlink()
    assert campaign(file, "--workers", 0, "--out", out, "--resume", "--json") == 0
    assert json.loads(capsys.readouterr().out)["simulations"] == 16
    assert first[1].stat().st_mtime_ns == kept
    (tmp_path / "short.yaml").write_text((tmp_path / "short.yaml").read_text() + "# changed\n")
    assert campaign(file, "--workers", 0, "--out", out, "--resume") == 2
    assert "started with other files: plan short.yaml" in capsys.readouterr().err
    assert campaign(file, "--workers", 0, "--out", out, "--overwrite") == 0
    assert len(table_of(out)) == 16


def test_a_share_that_is_not_reached_is_exit_code_1(tmp_path, capsys):
    text = (
        "name: own\nplan: short.yaml\nvary: {effect.backlash.half_gap_rad: [0.001, 0.2]}\npass_share: 0.9\n"
    )
    assert campaign(written(tmp_path, text), "--workers", 0, "--out", tmp_path / "out") == 1
    said = capsys.readouterr().out
    assert "not reached" in said
    assert "1 of 2 (50.0 %) pass" in said  # a grid is no sample: no interval
    assert (
        json.loads((tmp_path / "out/campaign.json").read_text())["controllers"][0]["share"]["interval"]
        is None
    )


def test_a_dry_run_says_how_many_and_how_long_and_writes_nothing(tmp_path, capsys):
    file = written(tmp_path)
    assert campaign(file, "--dry-run", "--workers", 2) == 0
    said = capsys.readouterr().out
    assert "16 simulations (2 values of model.vehicle_inertia" in said
    assert campaign(file, "--dry-run", "--json") == 0
    assert json.loads(capsys.readouterr().out)["simulations"] == 16
    assert {path.name for path in tmp_path.iterdir()} == {"short.yaml", "campaign.yaml"}


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--resume",), "--resume goes with --out"),
        (("--resume", "--overwrite", "--out", "out"), "--overwrite does not go with --resume"),
        (("--workers", "1", "--scheduler", "tcp://127.0.0.1:9"), "--workers does not go with --scheduler"),
    ],
)
def test_options_that_do_not_go_together_are_refused(tmp_path, capsys, options, said, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert campaign(written(tmp_path), *options) == 2
    assert said in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_without_dask_it_says_what_to_install(tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    monkeypatch.delitem(sys.modules, "hil.campaign.on_dask", raising=False)
    assert campaign(written(tmp_path), "--workers", 1, "--out", tmp_path / "out") == 2
    said = capsys.readouterr().err
    assert "pip install 'eaxle-hil[campaign]'" in said
    assert "or --workers 0" in said


@contextlib.contextmanager
def started(*arguments, env=None):
    """The command in a process group of its own, as from a terminal."""
    process = subprocess.Popen(
        [HIL, "campaign", *map(str, arguments)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        env=env,
    )
    try:
        yield process
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.communicate()


def await_parts(out, count, process):
    while len(list(out.glob("simulations/part-*"))) < count:
        assert process.poll() is None, process.communicate()
        time.sleep(0.02)


def workers_of(process):
    """Processes of a command's workers."""
    found = []
    for place in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError, IndexError):
            parent = place.joinpath("stat").read_text().rpartition(")")[2].split()[1]
            if int(parent) == process.pid and b"spawn_main" in place.joinpath("cmdline").read_bytes():
                found.append(int(place.name))
    return found


def refuse_loss(out, count):
    """Every simulation stands once, with the values that it has in one process."""
    table = table_of(out)
    assert list(table["simulation"]) == list(range(count))
    assert table["error"].isna().all()


@pytest.mark.slow
def test_ctrl_c_keeps_what_is_done_and_says_how_to_go_on(tmp_path):
    file, out = written(tmp_path, LONG), tmp_path / "out"
    with started(file, "--workers", 2, "--out", out) as process:
        await_parts(out, 1, process)
        os.killpg(process.pid, signal.SIGINT)
        said, err = process.communicate(timeout=60)
    assert (process.returncode, said) == (130, "")
    kept = len(table_of(out))
    assert (
        f"{kept} of 1500 simulations are kept; continue with: hil campaign {file} --out {out} --resume" in err
    )
    assert err.count("\n") == 2
    assert 0 < kept < 1500
    assert not workers_of(process)


@pytest.mark.slow
def test_nothing_is_lost_or_done_twice_when_a_worker_and_then_the_command_are_killed(tmp_path):
    file, out = written(tmp_path, LONG), tmp_path / "out"
    with started(file, "--workers", 2, "--out", out) as process:
        await_parts(out, 1, process)
        os.kill(workers_of(process)[0], signal.SIGKILL)
        await_parts(out, 3, process)
        process.kill()
        process.wait()
        kept = {path.name: path.stat().st_mtime_ns for path in out.glob("simulations/part-*")}
    assert not (out / "campaign.json").exists()
    assert campaign(file, "--workers", 0, "--out", out, "--resume") == 0
    refuse_loss(out, 1500)
    after = {path.name: path.stat().st_mtime_ns for path in out.glob("simulations/part-*")}
    assert kept.items() <= after.items()


DEADLY = """
import os, sys
if "spawn_main" in " ".join(sys.orig_argv):
    from hil.campaign import Simulations
    row = Simulations.row
    Simulations.row = lambda self, number: os._exit(1) if number == 5 else row(self, number)
"""


@pytest.mark.hunt  # a minute of processes that die: the slow set kills a worker and the command
def test_a_simulation_that_kills_its_workers_is_found_and_costs_no_other(tmp_path):
    text = "name: deadly\nplan: short.yaml\ndraws: 24\ntolerance: {sensor_noise: 1}\n"
    file, out = written(tmp_path, text), tmp_path / "out"
    (tmp_path / "sitecustomize.py").write_text(DEADLY)
    path = os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])
    with started(file, "--workers", 2, "--out", out, env={**os.environ, "PYTHONPATH": path}) as process:
        said, err = process.communicate(timeout=300)
    assert (process.returncode, err) == (0, "")
    assert "1 with: the process that simulated it died each time" in said
    table = table_of(out)
    assert list(table["simulation"]) == list(range(24))
    assert list(table.loc[table["error"].notna(), "simulation"]) == [5]


@pytest.mark.hunt  # a minute of processes that die: the slow set kills a worker and the command
def test_a_scheduler_that_is_killed_is_exit_code_3_and_gone_on_with(tmp_path):
    file, out = written(tmp_path, LONG), tmp_path / "out"
    folder = Path(sys.executable).parent
    address = tmp_path / "scheduler.json"
    common = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "cwd": tmp_path}
    host = ["--host", "127.0.0.1"]
    scheduler = subprocess.Popen(
        [folder / "dask", "scheduler", *host, "--port", "0", "--no-dashboard", "--scheduler-file", address],
        **common,
    )
    worker = None
    try:
        while not address.exists() or not address.read_text().rstrip().endswith("}"):
            assert scheduler.poll() is None
            time.sleep(0.05)
        where = json.loads(address.read_text())["address"]
        worker = subprocess.Popen(
            [folder / "dask", "worker", where, *host, "--nthreads", "1", "--no-dashboard", "--no-nanny"],
            **common,
        )
        with started(file, "--scheduler", where, "--out", out) as process:
            await_parts(out, 1, process)
            scheduler.kill()
            _, err = process.communicate(timeout=60)
    finally:
        for one in (scheduler, worker):
            if one is not None:
                one.kill()
                one.wait()
    assert process.returncode == 3
    assert "the connection to the scheduler is lost" in err
    assert "--resume" in err
    assert campaign(file, "--workers", 0, "--out", out, "--resume") == 0
    refuse_loss(out, 1500)
