"""`hil serve` as its users have it: runs are queued, watched, ended; nothing is lost."""

from __future__ import annotations

import datetime
import itertools
import json
import os
import socket
import time
from pathlib import Path

import pytest

from hil.core.errors import BadInputError, BenchError
from hil.core.result import RunResult
from hil.execution.data_folder import folder_of
from hil.execution.run_process import alive_in
from hil.service.serving import ServeRequest, make_token, serve
from tests.hil.service.served import ASKING, SHORT, RefusedError, Served, served


def test_a_run_is_queued_carried_out_and_found_again(service: Served) -> None:
    run = service.queue(values={"torque_nm": 120})
    over = service.over(run)
    assert (over["state"], over["exit_code"], over["verdict"]) == ("ended", 0, "pass")
    assert over["safe_state"] == "confirmed"
    assert {"recording.mcap", "result.json", "report.html", "report.pdf"} <= set(over["files"])
    result = RunResult.model_validate(service.get(f"/runs/{run}/files/result.json"))
    assert [(one.name, one.value) for one in result.variables] == [("torque_nm", 120.0)]
    assert service.get(f"/runs/{run}/files/recording.mcap").startswith(b"\x89MCAP0")


@pytest.mark.slow
def test_runs_of_a_bench_go_one_after_the_other_by_priority(service: Served) -> None:
    first = service.queue("asking")
    service.until(first, lambda run: run["state"] == "running")
    low, high = service.queue(), service.queue(priority=5)
    assert [service.get(f"/runs/{run}")["state"] for run in (low, high)] == ["queued", "queued"]
    _answer_until_over(service, first)
    runs = [service.over(run) for run in (first, high, low)]
    assert all(run["exit_code"] == 0 for run in runs)
    for before, after in itertools.pairwise(runs):
        assert before["ended_at"] <= after["started_at"]


def test_a_run_that_waits_is_cancelled_and_one_under_way_ends_safely(service: Served) -> None:
    first = service.queue("asking")
    service.until(first, lambda run: run["state"] == "running" and run["share"] is not None)
    second = service.queue()
    assert service.post(f"/runs/{second}/abort")["state"] == "cancelled"
    assert service.post(f"/runs/{first}/abort")["doing"].startswith("being ended")
    over = service.over(first)
    assert (over["exit_code"], over["safe_state"]) == (130, "confirmed")
    assert "recording.mcap" in over["files"]


@pytest.mark.slow
def test_what_a_run_asked_is_shown_until_somebody_answers(service: Served) -> None:
    """Not while it goes on, for minutes."""
    goes_on = "'Is the cage shut?'}\n  - hold_speed: {speed_km_h: 0, duration_s: 3000}"
    service.give("going-on", ASKING.replace("'Is the cage shut?'}", goes_on).replace("asking", "going-on"))
    run = service.queue("going-on")
    service.until(run, lambda found: "cage" in found["message"])
    service.post(f"/runs/{run}/answer", {"text": "yes"})
    service.until(run, lambda found: found["state"] == "running" and not found["message"])
    service.post(f"/runs/{run}/abort")
    assert service.over(run)["exit_code"] == 130


@pytest.mark.slow
def test_an_emergency_stop_latches_the_bench_until_somebody_resets_it(service: Served) -> None:
    run = service.queue("asking")
    service.until(run, lambda found: found["state"] == "running" and found["share"] is not None)
    waiting = service.queue()
    assert service.post("/benches/sim/emergency-stop")["state"] == "emergency_stop"
    over = service.over(run)
    assert (over["exit_code"], over["safe_state"]) == (3, "confirmed")
    time.sleep(1.0)
    assert service.get(f"/runs/{waiting}")["state"] == "queued"
    assert service.post("/benches/sim/reset")["state"] != "emergency_stop"
    assert service.over(waiting)["exit_code"] == 0


def test_a_repeated_request_queues_no_second_run(service: Served) -> None:
    assert service.queue(key="once") == service.queue(key="once")


def test_what_makes_no_sense_is_refused_with_what_to_do(service: Served) -> None:
    for body, status in (
        ({"plan": "none", "bench": "sim"}, 404),
        ({"plan": "short", "bench": "none"}, 404),
        ({"plan": "short", "bench": "sim", "values": {"torque_nm": 900}}, 422),
        ({"plan": "short", "bench": "sim", "values": {"torque": 1}}, 422),
        ({"plan": "../short", "bench": "sim"}, 422),
    ):
        with pytest.raises(RefusedError) as refused:
            service.post("/runs", body)
        assert (refused.value.status, bool(refused.value.problem["what"])) == (status, True)


def test_a_given_plan_reaches_no_file_of_the_machine(service: Served) -> None:
    for file in ("/etc/passwd", "../runs/000001/plan.yaml", "sub/x.toml"):
        with pytest.raises(RefusedError, match="loads the file"):
            service.give("short", SHORT.replace("phase_stabilization.toml", file))
    for name in ("..%2Fservice.sqlite", "%2e%2e", "run.lock", ".", "plan.yaml%00"):
        with pytest.raises(RefusedError) as refused:
            service.get(f"/runs/1/files/{name}")
        assert refused.value.status in (404, 422)


@pytest.mark.slow
def test_a_killed_service_loses_nothing_and_runs_nothing_twice(tmp_path: Path) -> None:
    data, state = tmp_path / "data", tmp_path / "state"
    with served(data, state=state) as service:
        service.give("asking", ASKING)
        service.give("short", SHORT)
        cut = service.queue("asking")
        waiting = service.queue()
        service.until(cut, lambda run: run["state"] == "running" and run["share"] is not None)
        service.process.kill()
        service.process.wait(10)
    folder = folder_of(data / "runs", cut)
    while alive_in(folder):
        time.sleep(0.05)
    hour_ago_s = time.time() - 3600.0
    for path in folder.rglob("*"):
        os.utime(path, (hour_ago_s, hour_ago_s))
    with served(data, state=state) as service:
        over = service.over(cut)
        ended_at = datetime.datetime.fromisoformat(over["ended_at"]).timestamp()
        assert ended_at == pytest.approx(hour_ago_s, abs=1.0)  # not the moment of the restart
        assert (over["state"], over["safe_state"]) == ("interrupted", "confirmed")
        assert over["reason"] == "the service ended during the run; data measured before that is kept"
        assert "recording.mcap" in over["files"]
        assert service.over(waiting)["exit_code"] == 0
        assert len(service.get("/runs")) == 2


@pytest.mark.slow
def test_ending_the_service_ends_its_run_safely(tmp_path: Path) -> None:
    data, state = tmp_path / "data", tmp_path / "state"
    with served(data, state=state) as service:
        service.give("asking", ASKING)
        run = service.queue("asking")
        service.until(run, lambda found: found["state"] == "running" and found["share"] is not None)
        service.process.terminate()
        assert service.process.wait(30) == 130
    result = json.loads((data / "runs/000001/result.json").read_text())
    assert result["safe_state"] == "confirmed"
    assert result["reason"] == "the service or agent that executed the run ended"


def test_a_second_service_and_an_open_one_without_tokens_are_refused(service: Served, tmp_path: Path) -> None:
    with pytest.raises(BadInputError, match="another service keeps its data here"):
        serve(_wanted(service.data))
    with pytest.raises(BadInputError, match="there is no token yet"):
        serve(_wanted(tmp_path, host="0.0.0.0"))
    with pytest.raises(BadInputError, match="no database can be opened"):
        serve(_wanted(tmp_path, database="nonsense"))
    (tmp_path / "file").touch()
    with pytest.raises(BadInputError, match="cannot be made a directory") as refused:
        serve(_wanted(tmp_path / "file"))
    assert "--data" in refused.value.fix
    with pytest.raises(BadInputError, match="used by two benches"):
        serve(_wanted(tmp_path, benches=("sim", "sim")))
    with pytest.raises(BadInputError, match="there is no role"):
        make_token(tmp_path, "", "me", "king")


def test_a_port_that_is_taken_is_said(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken, pytest.raises(BenchError, match="cannot listen"):
        serve(_wanted(tmp_path, port=taken.getsockname()[1]))


def _wanted(
    folder: Path,
    *,
    benches: tuple[str, ...] = ("sim",),
    host: str = "127.0.0.1",
    port: int = 0,
    database: str = "",
) -> ServeRequest:
    return ServeRequest(folder, benches, host=host, port=port, database=database)


def _answer_until_over(service: Served, run: int) -> None:
    while service.get(f"/runs/{run}")["state"] == "running":
        try:
            service.post(f"/runs/{run}/answer", {"text": "shut"})
        except RefusedError as error:
            assert error.status == 409
        time.sleep(0.1)
