"""What is handed out, kept and gone on with: in this process, and on a scheduler's workers."""

import json
from functools import partial

import pandas as pd
import pyarrow.parquet as pq
import pytest
from distributed import LocalCluster

from hil.campaign import (
    FOLDER,
    STARTED,
    Batch,
    Here,
    Parts,
    Progress,
    Simulations,
    batch_size,
    begun_batch,
    execute,
    load_setting,
    write_begun,
)
from hil.campaign.on_dask import Workers, _rows, rows_of
from hil.core.errors import BadInputError, BenchError
from tests.hil.campaign.short import written


@pytest.fixture(scope="module")
def simulations(tmp_path_factory):
    return Simulations(load_setting(written(tmp_path_factory.mktemp("campaign"))))


@pytest.fixture
def parts(tmp_path, simulations):
    write_begun(tmp_path, simulations.setting, 3)
    return Parts(tmp_path, simulations.setting, simulations.drawn, 3)


def test_every_simulation_stands_once_with_units(parts, simulations):
    shown: list[Progress] = []
    assert execute(parts, Here(simulations.rows), simulations.failed, show=shown.append)
    table = parts.table()
    assert list(table["simulation"]) == list(range(16))
    assert [path.name for path in sorted(parts.folder.iterdir())][-1] == "part-0000015-0000015.parquet"
    assert [one.done for one in shown] == [0, 3, 6, 9, 12, 15, 16]
    assert "16 of 16" in str(shown[-1])
    assert "left" in str(shown[1])
    fields = pq.read_schema(next(parts.folder.iterdir()))
    assert fields.field("model.vehicle_inertia").metadata[b"unit"] == "kg m²".encode()
    assert fields.field("value.phase.peak_shaft_torque").metadata[b"unit"] == b"N m"
    assert pd.read_parquet(parts.folder).shape == table.shape


def test_only_what_is_missing_or_damaged_is_done_again(parts, simulations, tmp_path):
    asked: list[int] = []

    class Counted(Here):
        def submit(self, batch):
            asked.append(batch.first)
            super().submit(batch)

    stops = iter([False, False, False, True])
    assert not execute(
        parts, Counted(simulations.rows), simulations.failed, stopped=lambda: next(stops, True)
    )
    assert asked == [0, 3, 6]
    assert len(parts.table()) == 9
    parts.path(Batch(3, 5)).write_bytes(b"PAR1 torn")
    asked.clear()
    assert begun_batch(tmp_path, simulations.setting) == 3
    assert execute(parts, Counted(simulations.rows), simulations.failed)
    assert asked == [3, 9, 12, 15]
    assert list(parts.table()["simulation"]) == list(range(16))


@pytest.mark.parametrize("changed", ["short.yaml", "campaign.yaml"])
def test_another_campaign_is_not_gone_on_with(tmp_path, changed):
    setting = load_setting(written(tmp_path))
    write_begun(tmp_path, setting, 3)
    (tmp_path / changed).write_text((tmp_path / changed).read_text() + "# changed\n")
    with pytest.raises(BadInputError, match=f"started with other files.*{changed}"):
        begun_batch(tmp_path, load_setting(tmp_path / "campaign.yaml"))


def test_what_was_begun_may_be_nothing_or_damaged(tmp_path, simulations):
    assert begun_batch(tmp_path, simulations.setting) == 0
    for content in ("{", "[]", json.dumps({"batch": 0, "identity": {}})):
        (tmp_path / STARTED).write_text(content)
        with pytest.raises(BadInputError, match="cannot be read"):
            begun_batch(tmp_path, simulations.setting)


def test_batches_take_seconds_and_leave_something_for_everybody():
    assert batch_size(10_000, 0.05, 2) == 60
    assert batch_size(100, 0.05, 2) == 13
    assert batch_size(10, 60.0, 2) == 1
    assert batch_size(1, 0.0, 64) == 1


class Deadly:
    """Carriers of which a simulation kills its process."""

    def __init__(self, simulations, deadly):
        self._here, self._deadly = Here(simulations.rows), deadly
        self.wanted = 1

    @property
    def under_way(self):
        return self._here.under_way

    def submit(self, batch):
        self._here.submit(batch)

    def keep_running_only(self):
        self._here.keep_running_only()

    def done(self):
        for batch, rows in self._here.done():
            assert rows is not None
            for number, row in zip(range(batch.first, batch.last + 1), rows, strict=True):
                yield Batch(number, number), None if number == self._deadly else [row]


def test_a_simulation_that_kills_its_process_is_a_row_and_its_part_is_whole(parts, simulations):
    assert execute(parts, Deadly(simulations, 4), simulations.failed)
    table = parts.table()
    assert list(table["simulation"]) == list(range(16))
    assert list(table.loc[table["verdict"] == "error", "simulation"]) == [4]
    assert "died each time" in table.loc[4, "error"]


@pytest.fixture(scope="module")
def cluster():
    port = {"dashboard_address": "127.0.0.1:0"}
    with LocalCluster(
        processes=False, n_workers=1, threads_per_worker=1, dashboard_address=None, scheduler_kwargs=port
    ) as found:
        yield found


def test_a_schedulers_workers_make_the_same_rows(parts, simulations, cluster, tmp_path):
    setting = simulations.setting
    with Workers(rows_of(setting), 0, cluster.scheduler_address) as workers:
        assert workers.count == 1
        assert execute(parts, workers, simulations.failed)
    there = parts.table().drop(columns="processor_s")
    other = Parts(tmp_path / "other", setting, simulations.drawn, 5)
    execute(other, Here(simulations.rows), simulations.failed)
    pd.testing.assert_frame_equal(there, other.table().drop(columns="processor_s"))


def test_a_worker_with_other_files_is_refused(parts, simulations, cluster):
    source = str(simulations.setting.file.source)
    with (
        Workers(partial(_rows, source, "0" * 64), 0, cluster.scheduler_address) as workers,
        pytest.raises(BadInputError, match="other files"),
    ):
        execute(parts, workers, simulations.failed)
    assert not (parts.folder).exists() or not list(parts.folder.iterdir())


def test_stopped_only_what_is_under_way_is_awaited(parts, simulations, cluster):
    setting = simulations.setting
    with Workers(rows_of(setting), 0, cluster.scheduler_address) as workers:
        started = iter([False])
        assert not execute(parts, workers, simulations.failed, stopped=lambda: next(started, True))
        assert workers.under_way == 0
    assert 3 <= len(parts.table()) < 16
    assert parts.folder.name == FOLDER


def test_no_scheduler_is_told(simulations, monkeypatch):
    monkeypatch.setattr("hil.campaign.on_dask._CONNECT_S", 0.5)
    with pytest.raises(BenchError, match="no scheduler answers"):
        Workers(rows_of(simulations.setting), 0, "tcp://127.0.0.1:9").__enter__()
