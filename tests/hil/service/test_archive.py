"""Files of runs in a store: brought there whatever happens, read back, given to those who ask."""

from __future__ import annotations

import asyncio
import hashlib
import os
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import Engine, text

from hil.api_schemas.campaign import CampaignWanted
from hil.api_schemas.study import IdentificationWanted
from hil.client import Client
from hil.client import RefusedError as AnswerError
from hil.core.errors import BadInputError
from hil.service.archive import Archive, ArchiveAwayError, Keeper
from hil.service.serving import ServeRequest, serve
from hil.service.store import BenchStore, FileStore, NewRun, RunStore, open_database
from tests.hil.analysis.tuning.trials import PLAN
from tests.hil.campaign.short import CAMPAIGN
from tests.hil.service.jobs.test_studies import CHIRP
from tests.hil.service.s3 import BUCKET, S3, s3_server
from tests.hil.service.served import SHORT, RefusedError, Served, served
from tests.hil.service.working import bench_called

STORE = f"s3://{BUCKET}/bench"


@pytest.fixture(scope="module")
def s3(tmp_path_factory: pytest.TempPathFactory) -> Iterator[S3]:
    with s3_server(tmp_path_factory.mktemp("s3")) as server:
        before = {name: os.environ.get(name) for name in server.environment}
        os.environ.update(server.environment)
        yield server
        for name, value in before.items():
            os.environ.pop(name) if value is None else os.environ.update({name: value})


def test_a_folder_gives_back_what_it_was_given(tmp_path: Path) -> None:
    archive, path = Archive(str(tmp_path / "archive")), tmp_path / "x.bin"
    for content in (b"", os.urandom(9_000_001)):
        path.write_bytes(content)
        kept = archive.put(path, "000001/x.bin")
        assert (kept.size, kept.sha256) == (len(content), hashlib.sha256(content).hexdigest())
    assert archive.read("000001/x.bin", 7, 4_000_100) == content[7:4_000_100]
    with pytest.raises(ArchiveAwayError, match="too short"):
        archive.read("000001/x.bin", 9_000_000, 9_000_005)
    with pytest.raises(ArchiveAwayError, match="the store cannot be reached"):
        archive.read("000001/none", 0, 1)


@pytest.mark.parametrize("url", ["nonsense://x", "s3://key:secret@bucket/x"])
def test_what_no_store_can_be_is_said_without_its_key(url: str, tmp_path: Path) -> None:
    with pytest.raises(BadInputError) as refused:
        Archive(url)
    assert (refused.value.where, "secret" in str(refused.value)) == ("--store", False)
    with pytest.raises(BadInputError):
        serve(ServeRequest(tmp_path / "data", ("sim",), store=url))
    assert not (tmp_path / "data").exists()


def test_a_keeper_goes_on_where_it_was_and_removes_nothing_that_is_not_kept(tmp_path: Path) -> None:
    engine = open_database(f"sqlite:///{tmp_path / 'service.sqlite'}")
    run, files = _a_run_that_is_over(engine), FileStore(engine)
    folder, archive = tmp_path / f"runs/{run:06d}", tmp_path / "archive"
    folder.mkdir(parents=True)
    for name in ("a.txt", "b.txt"):
        (folder / name).write_text(name)

    def keep() -> Keeper:
        keeper = Keeper(Archive(str(archive)), files, "me", tmp_path / "runs", set, 0.0)
        asyncio.run(_until_kept(keeper))
        return keeper

    keep()
    assert files.kept([run]) == [run]
    with engine.begin() as connection:  # as if it had been killed between the two
        connection.execute(text("UPDATE runs SET kept_at = NULL"))
        connection.execute(text("DELETE FROM files WHERE name = 'b.txt'"))
    for path in archive.rglob("*.txt"):
        path.write_text("another")
    keep()
    assert (archive / f"{run:06d}/a.txt").read_text() == "another", "what is kept is not brought twice"
    assert (archive / f"{run:06d}/b.txt").read_text() == "b.txt"
    (folder / "c.txt").write_text("came later")
    for path in folder.iterdir():
        os.utime(path, (0, 0))
    keeper = keep()
    assert [path.name for path in folder.iterdir()] == ["c.txt"]
    assert asyncio.run(keeper.bring_back(run, "b.txt")).read_text() == "b.txt"
    with pytest.raises(ArchiveAwayError, match="cannot be reached|differs from the one written"):
        asyncio.run(keeper.bring_back(run, "a.txt"))
    assert not (folder / "a.txt").exists()


def _a_run_that_is_over(engine: Engine) -> int:
    runs = RunStore(engine)
    BenchStore(engine, "me").hold("sim")
    run, _ = runs.add(NewRun("p", "P", "name: p", "p.yaml", "sim", {}, "anna"), approved=True)
    assert runs.take(run.id, "me") is not None
    runs.end(run.id, "ended", exit_code=0)
    return run.id


async def _until_kept(keeper: Keeper) -> None:
    work = asyncio.create_task(keeper.work())
    while keeper.rounds.count == 0:
        await asyncio.sleep(0.01)
    work.cancel()


@pytest.mark.slow
def test_files_are_kept_in_s3_and_given_from_there(s3: S3, tmp_path: Path) -> None:
    data, state = tmp_path / "data", tmp_path / "state"
    with served(data, "--store", STORE, "--keep-local", "0", state=state) as service:
        service.give("short", SHORT)
        run = service.queue()
        files = service.over(run)["files"]
        here = {name: service.get(f"/runs/{run}/files/{name}") for name in files if name.endswith(".pdf")}
        here["recording.mcap"] = service.get(f"/runs/{run}/files/recording.mcap")
        _until(lambda: service.get("/health")["runs_not_stored"] == 0)
        assert {f"bench/{run:06d}/{name}" for name in files} <= set(s3.names())
        folder = data / f"runs/{run:06d}"
        for path in folder.iterdir():
            os.utime(path, (0, 0))
        second = service.queue()
        service.over(second)  # what is old is looked for when a run was kept
        _until(lambda: not folder.exists())
        assert service.get(f"/runs/{run}")["files"] == files
        for name, content in here.items():
            assert service.get(f"/runs/{run}/files/{name}") == content
        whole = here["recording.mcap"]
        for wanted, part in (
            ("bytes=0-7", whole[:8]),
            ("bytes=-9", whole[-9:]),
            (f"bytes={len(whole) - 3}-", whole[-3:]),
        ):
            assert _ranged(service, run, wanted) == (206, part)
        assert _ranged(service, run, "lines=1-2") == (200, whole)
        with pytest.raises(RefusedError) as refused:
            _ranged(service, run, f"bytes={len(whole)}-")
        assert refused.value.status == 416
        found = service.get(f"/comparisons?first={run}&other={second}")
        assert found["first"]["id"] == run
        assert (folder / "recording.mcap").read_bytes() == whole, "brought back to be read"


@pytest.mark.slow
def test_a_store_that_is_away_holds_no_run_up_and_loses_no_file(s3: S3, tmp_path: Path) -> None:
    data, state = tmp_path / "data", tmp_path / "state"
    s3.end()
    with served(data, "--store", f"{STORE}-away", "--keep-local", "0", state=state) as service:
        service.give("short", SHORT)
        run = service.queue()
        over = service.over(run)
        assert over["exit_code"] == 0
        _until(lambda: "the store cannot be reached" in service.get("/health")["store_problem"])
        assert service.get("/health")["runs_not_stored"] == 1
        assert b"hil_runs_not_stored 1" in service.get("/metrics")
        assert service.get(f"/runs/{run}/files/recording.mcap").startswith(b"\x89MCAP0")
        service.process.kill()
        service.process.wait(10)
    s3.begin()
    with served(data, "--store", f"{STORE}-away", "--keep-local", "0", state=state) as service:
        _until(lambda: service.get("/health")["runs_not_stored"] == 0)
        assert service.get("/health")["store_problem"] == ""
        kept = {name for name in s3.names() if name.startswith("bench-away/")}
        assert kept == {f"bench-away/{run:06d}/{name}" for name in over["files"]}
        for path in (data / f"runs/{run:06d}").iterdir():
            there = s3.folder / "kept" / BUCKET / f"bench-away/{run:06d}" / path.name
            assert path.name == "run.lock" or there.read_bytes() == path.read_bytes()


@pytest.mark.slow
def test_what_a_study_and_a_campaign_left_is_read_at_another_service(s3: S3, tmp_path: Path) -> None:
    database = ("--database", f"sqlite:///{tmp_path / 'shared.sqlite'}", "--store", f"{STORE}-results")
    arguments, state = (*database, "--workers", "0"), tmp_path / "state"
    bench = bench_called("other", tmp_path / "benches")
    with served(tmp_path / "two", *arguments, "--bench", str(bench), state=state) as second:
        two = Client(second.url)
        with served(tmp_path / "one", *arguments, state=state) as first:
            one = Client(first.url)
            first.give("chirp", CHIRP)
            run = first.queue("chirp")
            assert first.over(run)["state"] == "ended"
            study = one.identify(IdentificationWanted(runs=[run]))
            campaign = one.add_campaign(CampaignWanted(text=CAMPAIGN, files={"short.yaml": PLAN}))
            _until(lambda: two.study(study.id).files and two.campaign(campaign.id).files, 240.0)
            _until(lambda: (one.health().results_not_stored, one.health().runs_not_stored) == (0, 0))
            found = one.study(study.id)
            assert (found.state, found.place, two.study(study.id).files) == ("ended", "", found.files)
            for ask in (
                lambda: two.remove_study(study.id),
                lambda: two.cancel_campaign(campaign.id),
                lambda: two.remove_campaign(campaign.id),
            ):
                with pytest.raises(AnswerError, match="belongs to another service") as refused:
                    ask()
                assert (refused.value.status, str(tmp_path / "one") in refused.value.fix) == (409, True)
            assert first.process.poll() is None
        _read_without_the_first(two, second, tmp_path / "one", study.id, campaign.id)
        assert two.identify(IdentificationWanted(runs=[run])).id == study.id + 1
        names = [name for name in s3.names() if name.startswith("bench-results/studies/000001/")]
        assert "report.html" in {name.rpartition("/")[2] for name in names}
    with served(tmp_path / "one", *arguments, state=state) as first:
        Client(first.url).remove_study(study.id)
        _until(lambda: not [name for name in s3.names() if "studies/000001/" in name])


def _read_without_the_first(two: Client, second: Served, data: Path, study: int, campaign: int) -> None:
    """All that the other service has left is read while its folder is away."""
    data.rename(data.with_name("away"))
    found = two.identification(study)
    assert str(data) in found.study.place
    assert found.resonance_hz is not None
    path = f"studies/{study:06d}/results/report.html"
    assert second.get(f"/studies/{study}/files/report.html") == (data.with_name("away") / path).read_bytes()
    assert second.get(f"/campaigns/{campaign}/files/simulations.parquet").startswith(b"PAR1")
    assert [(one.id, one.state) for one in two.campaigns()] == [(campaign, "ended")]
    data.with_name("away").rename(data)


def _ranged(service: Served, run: int, wanted: str) -> tuple[int, bytes]:
    url = f"{service.url}/api/v1/runs/{run}/files/recording.mcap"
    request = urllib.request.Request(url, headers={"Range": wanted})
    try:
        with urllib.request.urlopen(request, timeout=30) as answer:
            return answer.status, answer.read()
    except urllib.error.HTTPError as error:
        with error:
            raise RefusedError(error.code, error.read()) from None


def _until(wanted: Callable[[], Any], within_s: float = 60.0) -> None:
    until_s = time.monotonic() + within_s
    while not wanted():
        assert time.monotonic() < until_s
        time.sleep(0.1)
