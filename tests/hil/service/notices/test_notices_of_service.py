"""The service on the simulated bench sends a webhook what happens there."""

from __future__ import annotations

import json
import subprocess
import time
from pathlib import Path
from typing import Any

import pytest

from tests.hil.service.notices.receivers import Posts, listening
from tests.hil.service.served import HIL, SHORT, served

pytestmark = pytest.mark.slow

_FAILING = SHORT.replace("upper: 400", "upper: 1")


def _got(server: Posts, type_: str) -> list[Any]:
    contents = [json.loads(body) for _, body in server.got]
    return [one["data"] for one in contents if one["type"] == type_]


def _wait_for(server: Posts, type_: str) -> Any:
    until_s = time.monotonic() + 60.0
    while not (found := _got(server, type_)):
        assert time.monotonic() < until_s, server.got
        time.sleep(0.05)
    return found


def test_a_run_that_fails_and_a_stop_are_sent_once(tmp_path: Path) -> None:
    with listening(Posts()) as server:
        notices = tmp_path / "notices.toml"
        notices.write_text(f'address = "http://there"\n[[webhook]]\nurl = "{server.url}"\n')
        begun = ("--rate", "1000", "--notices", str(notices))
        with served(tmp_path / "data", *begun, state=tmp_path / "state") as service:
            service.give("short", SHORT)
            service.give("failing", _FAILING.replace("name: short", "name: failing"))
            service.over(service.queue())
            failed = service.queue("failing")
            service.over(failed)
            data = _wait_for(server, "run_failed")[0]
            assert data["run"]["id"] == failed
            assert data["url"] == f"http://there/runs/{failed}"
            assert "FAIL" in data["subject"]
            service.ask("POST", "/api/v1/benches/sim/emergency-stop")
            assert _wait_for(server, "bench_stopped")[0]["bench"] == "sim"
        with served(tmp_path / "data", *begun, state=tmp_path / "state") as service:
            service.get("/benches")
            time.sleep(2.5)  # two looks
    assert len(_got(server, "run_failed")) == 1  # the run that passed was not asked for
    assert len(_got(server, "bench_stopped")) == 1


def test_a_test_notice_says_who_got_it(tmp_path: Path) -> None:
    with listening(Posts()) as server:
        notices = tmp_path / "notices.toml"
        nobody = '[[webhook]]\nurl = "http://127.0.0.1:9/"\n'
        notices.write_text(f'{nobody}[[webhook]]\nurl = "{server.url}"\n')
        command = [
            *HIL,
            "serve",
            "--data",
            str(tmp_path),
            "--notices",
            str(notices),
            "--test-notices",
            "--json",
        ]
        done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    sent = json.loads(done.stdout)["sent"]
    assert done.returncode == 3
    assert "not taken" in sent[0]["problem"]
    assert sent[1]["problem"] == ""
    assert json.loads(server.got[0][1])["type"] == "test"
