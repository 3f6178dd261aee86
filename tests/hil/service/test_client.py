"""The typed client and `hil --server`, against the real service."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import time
from pathlib import Path

import pytest

from hil.api_schemas.api import RunWanted
from hil.client import Client, RefusedError
from hil.core.errors import BenchError
from hil.core.recording import read_recording
from test_plans import library_controllers
from tests.hil.service.served import HIL, SHORT, Served

PLAN = SHORT.replace("name: short", "name: mine")


def hil(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run([*HIL, *arguments], cwd=cwd, capture_output=True, text=True, timeout=120)


def test_the_client_gives_what_the_service_says(service: Served, tmp_path: Path) -> None:
    client = Client(service.url)
    assert client.health().status == "ok"
    assert client.me().role == "admin"
    assert "acceptance" in {plan.name for plan in client.plans()}
    assert client.give_plan("mine", PLAN).variables["torque_nm"].upper == 200.0
    newer = PLAN.replace("upper: 400", "upper: 390")
    assert client.give_plan("mine", newer, instead_of=PLAN).name == "mine"
    with pytest.raises(RefusedError, match="was saved by local"):
        client.give_plan("mine", PLAN.replace("upper: 400", "upper: 380"), instead_of=PLAN)
    assert client.lease("sim", 5.0).holder == "local"
    run = client.queue(RunWanted(plan="mine", bench="sim", values={"torque_nm": 90}))
    states = [found.state for found in client.progress(run.id)]
    assert states[-1] == "ended"
    assert client.give_back("sim").lease == ""
    client.download(run.id, "recording.mcap", tmp_path / "here.mcap")
    assert len(read_recording(tmp_path / "here.mcap").time_s) > 1000
    assert run.id in {found.id for found in client.runs("sim")}
    assert client.audit()[0].action == "lease given back"


def test_the_client_tells_refusals_from_services_that_are_not_there(service: Served) -> None:
    with pytest.raises(RefusedError, match="there is no run '99999'"):
        Client(service.url).run(99999)
    with pytest.raises(BenchError, match="cannot be reached"):
        Client("http://127.0.0.1:9").health()
    with pytest.raises(BenchError, match="cannot be reached"):
        Client("not an address").health()


@pytest.mark.slow
def test_a_run_of_a_service_has_the_exit_code_and_the_files_of_one_here(
    service: Served, tmp_path: Path
) -> None:
    (tmp_path / "mine.yaml").write_text(PLAN.replace("upper: 400", "upper: 4"))
    done = hil("--server", service.url, "run", "mine.yaml", "--set", "torque_nm=80", "--json", cwd=tmp_path)
    assert done.returncode == 1, done.stderr
    result = json.loads(done.stdout)
    folder = tmp_path / "out/mine-001"
    assert {path.name for path in folder.iterdir()} == set(result["files"].values()) | {"result.json"}
    assert json.loads((folder / "result.json").read_text()) == result


@pytest.mark.slow
def test_files_that_a_plan_names_travel_with_it(service: Served, tmp_path: Path) -> None:
    """Also from another folder, and where the service has another content under the name."""
    built_in = library_controllers()["phase_stabilization"].read_text()
    (tmp_path / "plans").mkdir()
    (tmp_path / "controller.toml").write_text(built_in)
    plan = PLAN.replace("name: mine", "name: starter").replace("upper: 400, unit: N m", "unit: N m")
    named = plan.replace("phase_stabilization.toml", "../controller.toml")
    (tmp_path / "plans/starter.yaml").write_text(named)
    folder = tmp_path / "out/starter-00"
    for number, torque_limit_nm in enumerate((150.0, 20.0), start=1):
        text = re.sub("torque_limit_nm = .*", f"torque_limit_nm = {torque_limit_nm}", built_in)
        (tmp_path / "controller.toml").write_text(text)
        done = hil("--server", service.url, "run", "plans/starter.yaml", "--json", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        recording = read_recording(Path(f"{folder}{number}/recording.mcap"))
        loaded = [content.decode() for content in recording.attachments.values()]
        assert text in loaded  # the one that lay here then


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("run", "none"), "there is no plan 'none'"),
        (("run", "acceptance", "--bench", "none"), "there is no bench 'none'"),
        (("run", "acceptance", "--repeat", "2"), "does not go with --server"),
        (("check", "acceptance"), "a service accepts the commands 'run', 'campaign' and 'list runs'"),
        (("run", "acceptance", "--bench", "../x"), "the service rejects it"),
    ],
)
@pytest.mark.slow
def test_what_a_service_cannot_do_is_said(
    service: Served, tmp_path: Path, arguments: tuple[str, ...], said: str
) -> None:
    done = hil("--server", service.url, *arguments, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert said in done.stderr
    assert not list(tmp_path.rglob("*.*"))


@pytest.mark.slow
def test_ctrl_c_here_ends_the_run_there(service: Served, tmp_path: Path) -> None:
    command = [*HIL, "--server", service.url, "run", "asking"]
    before = len(service.get("/runs"))
    process = subprocess.Popen(command, cwd=tmp_path, env=dict(os.environ), stderr=subprocess.PIPE, text=True)
    while len(service.get("/runs")) == before:
        assert process.poll() is None
        time.sleep(0.2)
    run = service.get("/runs")[0]["id"]
    service.until(run, lambda found: found["message"] != "")
    process.send_signal(signal.SIGINT)
    said = process.communicate(timeout=60)[1]
    assert (process.returncode, "stopped by the operator" in said) == (130, True)
    assert service.over(run)["safe_state"] == "confirmed"
    assert (tmp_path / "out/asking-001/recording.mcap").is_file()
