"""Agents as their users have them: real ones and a real service on loopback, killed and started again."""

from __future__ import annotations

import re
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from hil.cli._app import guarded
from hil.cli.commands.bench_agent import execute
from hil.cli.options.benches import BenchAgent
from hil.core.errors import BadInputError
from hil.core.files.locks import lock_on
from tests.hil.service.served import ASKING, HIL, SHORT, RefusedError, Served, environment_of, served
from tests.hil.service.working import Working, bench_called, started, working

#: Some seconds of work in virtual time, whoever looks on.
LONG = SHORT.replace("name: short", "name: long").replace(
    "duration_s: 0.2}\n  - step", "duration_s: 40}\n  - step"
)


@pytest.fixture(scope="module")
def far(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return bench_called("far", tmp_path_factory.mktemp("benches"))


@pytest.fixture(scope="module")
def agent(service: Served, far: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Working]:
    folder = tmp_path_factory.mktemp("agent")
    with working(service.url, folder / "data", far, state=folder / "state") as one:
        yield one


def test_a_run_on_an_agents_bench_is_as_one_of_the_services_own(service: Served, agent: Working) -> None:
    assert agent.told["away"] == ""
    bench = service.get("/benches/far")
    assert (bench["state"], bench["away_since"], bool(bench["machine"])) == ("free", None, True)
    run = service.queue(bench="far", values={"torque_nm": 120})
    over = service.over(run)
    assert (over["state"], over["exit_code"], over["verdict"]) == ("ended", 0, "pass")
    here, there = service.data / f"runs/{run:06d}", agent.folder_of(run)
    for name in ("recording.mcap", "result.json", "report.html", "report.pdf", "junit.xml", "plan.yaml"):
        assert name in over["files"]
        assert (here / name).read_bytes() == (there / name).read_bytes(), name
    assert re.search("hil_agents_connected [1-9]", service.get("/metrics").decode())
    assert [one["benches"] for one in service.get("/agents") if one["connected"]] == [["far"]]
    done = [(one["action"], one["target"]) for one in service.get("/audit") if one["target"] == f"run {run}"]
    assert done == [("run delivered", f"run {run}"), ("take", f"run {run}"), ("queue", f"run {run}")]
    trend = {one["criterion"] for one in service.get("/trends?bench=far&plan=short")}
    assert "s.peak_shaft_torque" in trend


@pytest.mark.slow
def test_a_run_of_an_agent_is_shown_live_answered_held_and_ended(service: Served, agent: Working) -> None:
    first = service.queue("asking", bench="far")
    service.until(first, lambda run: "cage" in run["message"])
    assert service.get("/benches/far")["running"] == first
    growing = service.data / f"runs/{first:06d}/recording.mcap"
    _until(lambda: growing.exists() and growing.stat().st_size > 10_000)
    service.post(f"/runs/{first}/answer", {"text": "shut"})
    assert service.over(first)["verdict"] == "pass"
    second = service.queue("asking", bench="far")
    service.until(second, lambda run: "cage" in run["message"])
    service.post(f"/runs/{second}/abort")
    over = service.over(second)
    assert (over["exit_code"], over["safe_state"]) == (130, "confirmed")


@pytest.mark.slow
def test_what_a_plan_will_do_is_predicted_where_the_bench_is(service: Served, agent: Working) -> None:
    del agent
    wanted = {"plan": "short", "bench": "far", "values": {"torque_nm": 150}}
    found, own = service.post("/forecasts", wanted), service.post("/forecasts", {**wanted, "bench": "sim"})
    assert found == own
    with pytest.raises(RefusedError, match="422"):
        service.post("/forecasts", {**wanted, "values": {"torque_nm": 900}})


@pytest.mark.slow
def test_an_emergency_stop_reaches_the_agent_which_latches_its_bench(service: Served, agent: Working) -> None:
    run = service.queue("asking", bench="far")
    service.until(run, lambda found: "cage" in found["message"])
    waiting = service.queue(bench="far")
    assert service.post("/benches/far/emergency-stop")["state"] == "emergency_stop"
    over = service.over(run)
    assert (over["exit_code"], over["safe_state"]) == (3, "confirmed")
    assert "not confirmed" not in service.get("/benches/far")["why"]
    time.sleep(1.0)
    assert service.get(f"/runs/{waiting}")["state"] == "queued"
    assert service.post("/benches/far/reset")["state"] != "emergency_stop"
    assert service.over(waiting)["exit_code"] == 0


@pytest.mark.slow
def test_a_run_goes_on_while_the_service_is_killed_and_is_steered_by_the_next(
    tmp_path: Path, far: Path
) -> None:
    data, state = tmp_path / "data", tmp_path / "state"
    with served(data, state=state) as service:
        port = service.url.rpartition(":")[2]
        service.give("asking", ASKING)
        with working(service.url, tmp_path / "agent", far, state=tmp_path / "far") as agent:
            run = service.queue("asking", bench="far")
            service.until(run, lambda found: "cage" in found["message"])
            service.process.kill()
            service.process.wait(10)
            time.sleep(2.0)
            assert not (agent.folder_of(run) / "result.json").exists(), "it waits for an answer"
            with served(data, "--port", port, state=state) as again:
                again.until(run, lambda found: "cage" in found["message"])
                again.post(f"/runs/{run}/answer", {"text": "shut"})
                over = again.over(run)
    assert (over["state"], over["exit_code"], over["verdict"]) == ("ended", 0, "pass")


@pytest.mark.slow
def test_what_was_measured_is_delivered_by_the_next_agent_to_the_next_service(
    tmp_path: Path, far: Path
) -> None:
    data, state, kept = tmp_path / "data", tmp_path / "state", tmp_path / "agent"
    with served(data, state=state) as service:
        port = service.url.rpartition(":")[2]
        service.give("long", LONG)
        with working(service.url, kept, far, state=tmp_path / "far") as agent:
            run = service.queue("long", bench="far")
            service.until(run, lambda found: found["share"] is not None)
            service.process.kill()
            service.process.wait(10)
            _until(lambda: (agent.folder_of(run) / ".ending.json").exists())
        assert agent.process.returncode == 130
    with working(f"http://127.0.0.1:{port}", kept, far, state=tmp_path / "far") as agent:
        assert "cannot be reached" in agent.told["away"]
        with served(data, "--port", port, state=state) as again:
            over = again.over(run)
            assert (over["state"], over["exit_code"], over["verdict"]) == ("ended", 0, "pass")
            assert (
                again.get(f"/runs/{run}/files/recording.mcap")
                == (agent.folder_of(run) / "recording.mcap").read_bytes()
            )


@pytest.mark.slow
def test_a_killed_agents_run_ends_safely_and_comes_when_the_agent_is_back(tmp_path: Path, far: Path) -> None:
    with served(tmp_path / "data", state=tmp_path / "state") as service:
        service.give("asking", ASKING)
        service.give("short", SHORT)
        with working(service.url, tmp_path / "agent", far, state=tmp_path / "far") as agent:
            cut = service.queue("asking", bench="far")
            waiting = service.queue(bench="far")
            service.until(cut, lambda found: "cage" in found["message"])
            agent.kill()
        _until(lambda: service.get("/benches/far")["state"] == "away")
        assert service.get(f"/runs/{cut}")["state"] == "running", "no one but the agent knows"
        with working(service.url, tmp_path / "agent", far, state=tmp_path / "far"):
            over = service.over(cut)
            assert (over["state"], over["safe_state"]) == ("interrupted", "confirmed")
            assert over["reason"] == "the agent ended during the run; data measured before that is kept"
            assert {"recording.mcap", "result.json", "report.pdf"} <= set(over["files"])
            assert service.over(waiting)["exit_code"] == 0


@pytest.mark.hunt
def test_ending_an_agent_ends_its_run_safely_and_delivers_it(tmp_path: Path, far: Path) -> None:
    with served(tmp_path / "data", state=tmp_path / "state") as service:
        service.give("asking", ASKING)
        with working(service.url, tmp_path / "agent", far, state=tmp_path / "far") as agent:
            run = service.queue("asking", bench="far")
            service.until(run, lambda found: "cage" in found["message"])
            agent.process.terminate()
            assert agent.process.wait(60) == 130
        over = service.get(f"/runs/{run}")
        assert (over["state"], over["safe_state"]) == ("interrupted", "confirmed")
        assert service.get("/benches/far")["state"] == "away"
        with pytest.raises(RefusedError, match="its agent does not answer"):
            service.post("/benches/far/reset")


@pytest.mark.hunt  # many processes; make service-stores carries it out, too
def test_two_agents_work_at_once_with_tokens_of_their_role(tmp_path: Path, far: Path) -> None:
    data = tmp_path / "data"
    root, cell = _token(data, "root=admin"), _token(data, "cell=agent")
    near = bench_called("near", tmp_path / "benches")
    with served(data, "--rate", "200", state=tmp_path / "state", token=root) as service:
        service.give("asking", ASKING)
        with (
            working(service.url, tmp_path / "one", far, state=tmp_path / "s1", token=cell),
            working(service.url, tmp_path / "two", near, state=tmp_path / "s2", token=cell),
        ):
            runs = [service.queue("asking", bench=bench) for bench in ("far", "near")]
            for run in runs:
                service.until(run, lambda found: "cage" in found["message"])
            assert [service.get(f"/runs/{run}")["state"] for run in runs] == ["running", "running"]
            for run in runs:
                service.post(f"/runs/{run}/answer", {"text": "shut"})
            assert [service.over(run)["verdict"] for run in runs] == ["pass", "pass"]
            second = started(service.url, tmp_path / "three", far, state=tmp_path / "s3", token=cell)
            assert _said(second) == 3, "the name is the first agent's"
        for wrong in ("hil_nonsense", _token(data, "eve=operator")):
            other = started(service.url, tmp_path / "four", far, state=tmp_path / "s3", token=wrong)
            assert _said(other) == 2
        with pytest.raises(RefusedError, match="403"):
            service.ask("GET", "/api/v1/runs", token=cell)
        assert {one["who"] for one in service.get("/audit") if one["action"] == "take"} == {"cell"}


def test_what_an_agent_cannot_use_is_said(tmp_path: Path) -> None:
    usual: dict[str, Any] = {"server": ["http://127.0.0.1:9"], "keep_local": 30.0, "as_json": True}
    for bench, name, for_s, said in (
        (["none"], "", None, "none"),
        (["sim"], "a\nb", None, "is not a valid name"),
        (["sim", "sim"], "", None, "used by two benches"),
        (["sim"], "", 0.0, "--for is 0"),
    ):
        with pytest.raises(BadInputError, match=said):
            execute(BenchAgent(data=tmp_path / "a", bench=bench, name=name, for_s=for_s, **usual))
    with lock_on(tmp_path), pytest.raises(BadInputError, match="another agent keeps its data here"):
        execute(BenchAgent(data=tmp_path, bench=["sim"], name="", for_s=None, **usual))


def test_a_service_has_benches_of_its_own_or_says_that_it_has_none(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert guarded(["serve", "--data", str(tmp_path / "data"), "--bench", "sim", "--no-bench"]) == 2
    assert "does not go with --no-bench" in capsys.readouterr().err
    assert not (tmp_path / "data").exists()


def _said(process: subprocess.Popen[str]) -> int:
    out, _ = process.communicate(timeout=60)
    assert out == ""
    return process.returncode


def _token(data: Path, wanted: str) -> str:
    command = [*HIL, "serve", "--data", str(data), "--add-token", wanted]
    done = subprocess.run(command, capture_output=True, text=True, check=True, env=environment_of(data))
    return done.stdout.splitlines()[-1]


def _until(wanted: Callable[[], bool], within_s: float = 40.0) -> None:
    until_s = time.monotonic() + within_s
    while not wanted():
        assert time.monotonic() < until_s
        time.sleep(0.1)
