"""`hil --server URL campaign`: what it brings, what it refuses, and Ctrl-C."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pandas as pd
import pytest

from hil.client import Client
from tests.hil.campaign.short import CAMPAIGN, written
from tests.hil.service.jobs.test_campaigns import LONG
from tests.hil.service.served import HIL, Served, served
from tests.hil.service.test_client import hil

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("remote-campaign")
    with served(folder / "data", "--workers", "0", state=folder / "state") as service:
        yield service


def test_its_files_and_exit_code_are_those_of_one_here(there: Served, tmp_path: Path) -> None:
    written(tmp_path, CAMPAIGN + "pass_share: 0.9\n")
    asked = ("--server", there.url, "campaign", "campaign.yaml", "--out", "out")
    done = hil(*asked, "--json", cwd=tmp_path)
    assert done.returncode == 1, done.stderr  # the notch does not pass as often
    told = json.loads(done.stdout)
    assert {path.name for path in (tmp_path / "out").iterdir()} == {*told["files"], told["table"]}
    assert list(pd.read_parquet(tmp_path / "out/simulations")["simulation"]) == list(range(16))
    assert "--overwrite" in hil(*asked, cwd=tmp_path).stderr
    again = hil(*asked, "--resume", cwd=tmp_path)
    assert (again.returncode, len(Client(there.url).campaigns())) == (1, 1), again.stderr
    assert "phase_stabilization: 8 of 8 (100.0 %; 63.1 to 100.0 %) pass\n" in again.stdout
    assert "required pass rate 90 %: not reached" in again.stdout
    here = hil("campaign", "campaign.yaml", "--out", "out", "--resume", "--workers", "0", cwd=tmp_path)
    assert (here.returncode, "16 simulations" in here.stdout) == (1, True), here.stderr


def test_what_cannot_be_asked_is_said_and_leaves_nothing(there: Served, tmp_path: Path) -> None:
    (tmp_path / "own.yaml").write_text("name: own\nplan: none\n")
    for arguments, said in (
        (("own.yaml",), "there is no plan 'none'"),
        (("own.yaml", "--resume"), "the service has no campaign of this content"),
        (("own.yaml", "--workers", "0"), "--workers does not go with --server"),
        (("robustness", "--dry-run"), "--dry-run does not go with --server"),
        (("missing.yaml",), "missing.yaml"),
    ):
        done = hil("--server", there.url, "campaign", *arguments, cwd=tmp_path)
        assert (done.returncode, done.stdout, said in done.stderr) == (2, "", True), done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["own.yaml"]


def test_ctrl_c_here_ends_it_there_and_it_is_gone_on_with(there: Served, tmp_path: Path) -> None:
    written(tmp_path, LONG)
    client, before = Client(there.url), len(there.get("/campaigns"))
    command = [*HIL, "--server", there.url, "campaign", "campaign.yaml"]
    process = subprocess.Popen(command, cwd=tmp_path, env=dict(os.environ), stderr=subprocess.PIPE, text=True)
    while len(client.campaigns()) == before or client.campaigns()[0].done == 0:
        assert process.poll() is None
        time.sleep(0.2)
    process.send_signal(signal.SIGINT)
    said = process.communicate(timeout=90)[1]
    assert (process.returncode, "of 1000 simulations are kept" in said) == (130, True), said
    kept = client.campaigns()[0]
    assert (kept.state, 0 < kept.done < 1000) == ("cancelled", True)
    done = hil("--server", there.url, "campaign", "campaign.yaml", "--resume", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "1000 simulations" in done.stdout
    assert len(client.campaigns()) == before + 1
