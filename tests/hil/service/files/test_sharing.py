"""Two services of one database: what is given to one is the other's, and a name stands for one content."""

from __future__ import annotations

import contextlib
import shutil
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from hil.client import Client, RefusedError
from hil.core.errors import BenchError
from hil.engine.bench.bench_file import shipped
from test_plans import library_controllers
from tests.hil.service.served import SHORT, Served, served
from tests.hil.service.served import RefusedError as AnswerError
from tests.hil.service.working import bench_called

CONTROLLER = library_controllers()["phase_stabilization"].read_text("utf-8")
MINE = SHORT.replace("name: short", "name: mine").replace("phase_stabilization.toml", "own.toml")


@contextlib.contextmanager
def two_of(url: str, folder: Path) -> Iterator[tuple[Served, Served]]:
    bench = bench_called("other", folder / "benches")
    with (
        served(folder / "one", "--database", url, state=folder / "state") as one,
        served(folder / "two", "--database", url, "--bench", str(bench), state=folder / "state") as two,
    ):
        yield one, two


@pytest.mark.slow
def test_what_is_given_to_one_runs_on_the_other_until_it_is_removed(url: str, tmp_path: Path) -> None:
    with two_of(url, tmp_path) as services:
        one, two = services
        first, second = Client(one.url), Client(two.url)
        first.give_controller("own", CONTROLLER)
        second.give_plan("mine", MINE)
        assert "own" in {found.name for found in second.controllers()}
        assert "mine" in {found.name for found in first.plans()}
        shutil.rmtree(tmp_path / "one/given")
        run = one.queue("mine")
        assert one.over(run)["verdict"] == "pass"
        with pytest.raises(AnswerError, match="is loaded by the plan 'mine'"):
            one.ask("DELETE", "/api/v1/controllers/own")
        one.ask("DELETE", "/api/v1/plans/mine")
        one.ask("DELETE", "/api/v1/controllers/own")
        assert "mine" not in {found.name for found in second.plans()}
        assert "own" not in {found.name for found in second.controllers()}
        assert list((tmp_path / "two/given/plans").iterdir()) == []
        _one_is_first(one, two)
        _one_removes(one, two)


def _one_is_first(first: Served, second: Served) -> None:
    """Of two who give a name to two services at once, each time."""
    for number in range(10):
        name, together = f"c{number}", threading.Barrier(2)
        texts = [CONTROLLER + f"# {number} of {who}\n" for who in ("one", "two")]
        with ThreadPoolExecutor(2) as both:
            asked = [
                both.submit(_given_at, together, service.url, name, text)
                for service, text in zip((first, second), texts, strict=True)
            ]
        won = [text for text, one in zip(texts, asked, strict=True) if one.result() is None]
        lost = [one.result() for one in asked if one.result() is not None]
        assert [(one.status, one.where, one.fix) for one in lost] == [(409, name, "give it another name")]
        assert "is already used for other content, given by local" in lost[0].what
        path = f"/controllers/{name}/text"
        assert [first.get(path).decode(), second.get(path).decode()] == 2 * won


def _one_removes(first: Served, second: Served) -> None:
    """Of two who remove one thing at two services at once: the other hears that it is not there."""
    model = shipped("three_inertia.toml").read_text("utf-8")
    for number in range(5):
        name, together = f"r{number}", threading.Barrier(2)
        plan = SHORT.replace("name: short", f"name: {name}")
        for kind, text in (("controller", CONTROLLER), ("model", model), ("plan", plan)):
            path = f"/api/v1/{kind}s/{name}"
            first.ask("PUT", path, text)
            assert second.get(f"/{kind}s/{name}/text").decode() == text
            with ThreadPoolExecutor(2) as both:
                asked = [both.submit(_removed_at, together, one, path) for one in (first, second)]
            heard = [one.result() for one in asked if one.result() is not None]
            assert [(one.status, one.problem["what"]) for one in heard] == [
                (404, f"there is no given {kind} '{name}'")
            ]
            log = first.ask("GET", "/api/v1/audit?most=20")
            assert [entry["action"] for entry in log if entry["target"] == name].count(f"{kind} removed") == 1


def _removed_at(together: threading.Barrier, service: Served, path: str) -> AnswerError | None:
    together.wait()
    try:
        service.ask("DELETE", path)
    except AnswerError as error:
        return error
    return None


def _given_at(together: threading.Barrier, url: str, name: str, text: str) -> RefusedError | None:
    together.wait()
    try:
        Client(url).give_controller(name, text)
    except RefusedError as error:
        return error
    return None


@pytest.mark.slow
def test_what_was_answered_is_there_after_a_kill_whatever_the_folder_has(tmp_path: Path) -> None:
    data, state = tmp_path / "data", tmp_path / "state"
    answered: list[str] = []
    with served(data, state=state) as service:
        client = Client(service.url)
        with contextlib.suppress(BenchError):
            while True:
                name = f"c{len(answered)}"
                client.give_controller(name, CONTROLLER + f"# {name}\n")
                if not answered:
                    threading.Timer(0.3, service.process.kill).start()
                answered.append(name)
                if len(answered) == 1:  # at the first: how long that takes is the machine's affair
                    threading.Timer(0.3, service.process.kill).start()
        service.process.wait(10)
    assert answered
    (data / "given/plans" / f"{answered[0]}.toml").unlink()
    (data / "given/plans" / f"{answered[-1]}.toml").write_text("by hand")
    with served(data, state=state) as service:
        client = Client(service.url)
        there = {found.name for found in client.controllers() if not found.built_in}
        assert set(answered) <= there <= {*answered, f"c{len(answered)}"}
        for name in there:
            assert service.get(f"/controllers/{name}/text").decode() == CONTROLLER + f"# {name}\n"


@pytest.mark.slow
def test_a_folder_of_an_earlier_version_is_shared_and_what_is_not_is_told(tmp_path: Path) -> None:
    url, bench = f"sqlite:///{tmp_path / 'shared.sqlite'}", bench_called("other", tmp_path / "benches")
    for name, short in (("one", SHORT), ("two", SHORT + "# other\n")):
        (tmp_path / name / "plans").mkdir(parents=True)
        (tmp_path / name / "plans/short.yaml").write_text(short)
        (tmp_path / name / "plans/own.toml").write_text(CONTROLLER)
    (tmp_path / "two/plans/mine.yaml").write_text(MINE)
    with served(tmp_path / "one", "--database", url, state=tmp_path / "state") as one:
        assert Client(one.url).kept_apart() == []
    with served(tmp_path / "two", "--database", url, "--bench", str(bench), state=tmp_path / "state") as two:
        client = Client(two.url)
        assert {found.name for found in client.plans() if not found.built_in} == {"short", "mine"}
        assert two.get("/plans/short/text").decode() == SHORT
        (apart,) = client.kept_apart()
        assert (apart.kind, apart.name, apart.file) == ("plan", "short", "plans/short.yaml")
        assert client.health().kept_apart == 1
    assert (tmp_path / "two/plans/short.yaml").read_text() == SHORT + "# other\n"
