"""The audit log is a chain: what was done to it past its guards is seen."""

from __future__ import annotations

import json
import sqlite3
import subprocess
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from sqlalchemy import Engine

from hil.service.audit import HEAD, problem_of
from hil.service.store import LogStore, open_database
from tests.hil.service.served import HIL, Served, served


def filled(engine: Engine, rows: int = 6) -> LogStore:
    log = LogStore(engine)
    for number in range(rows):
        log.add("anna", "operator", "queue", f"run {number}", "é\U0001f600 \"'")
    return log


def test_a_log_that_nobody_touched_is_whole_also_if_several_write(engine: Engine) -> None:
    log = filled(engine)
    with ThreadPoolExecutor(4) as several:
        list(several.map(lambda who: log.add(str(who), "", "does", "something"), range(40)))
    found = log.check()
    assert (found.rows, found.problem, found.head.id) == (46, "", log.newest(1000, 1)[0].id)
    assert log.check(found.head).problem == ""


def test_what_the_log_has_no_room_for_leaves_a_sign(engine: Engine) -> None:
    log = LogStore(engine)
    log.add("anna", "operator", "note added", "r" * 201, "d" * 2000)
    entry = log.newest(1000, 1)[0]
    assert entry.target == "r" * 199 + "…"
    assert entry.detail == "d" * 2000


@pytest.mark.slow
@pytest.mark.parametrize(
    "change",
    [
        "UPDATE audit SET who = 'no one' WHERE id = 3",
        "UPDATE audit SET at = '2020-01-01 00:00:00.000000' WHERE id = 1",
        "DELETE FROM audit WHERE id = 3",
        "REPLACE INTO audit SELECT id, at, 'x', role, action, target, detail, chain FROM audit WHERE id = 2",
        "INSERT INTO audit SELECT 100, at, who, role, action, target, detail, chain FROM audit WHERE id = 6",
        "UPDATE audit SET chain = '' WHERE id = 4",
    ],
)
def test_a_row_that_was_changed_past_the_guards_is_seen(change: str, tmp_path: Path) -> None:
    data = tmp_path / "data"
    _made(data)
    _past_the_guards(data, change)
    done = _verified(data)
    assert done.returncode == 1
    assert "was changed, removed or inserted" in done.stdout


@pytest.mark.slow
def test_rows_that_are_missing_at_the_end_are_seen_by_where_it_ended_once(tmp_path: Path) -> None:
    data = tmp_path / "data"
    _made(data)
    assert _verified(data).returncode == 0
    with served(data, state=tmp_path / "state") as service:
        assert service.get("/health")["audit_problem"] == ""
    _past_the_guards(data, "DELETE FROM audit WHERE id = (SELECT max(id) FROM audit)")
    done = _verified(data)
    assert (done.returncode, "is not there any more" in done.stdout) == (1, True)
    with served(data, state=tmp_path / "state") as service:
        _until_told(service)


def test_rows_of_an_earlier_version_are_part_of_the_chain(engine: Engine, tmp_path: Path) -> None:
    if engine.dialect.name != "sqlite":
        pytest.skip("the same on every database")
    then, columns = "2025-01-01 00:00:00.000000", "at, who, role, action, target, detail"
    with engine.begin() as connection:
        for who in ("one", "two"):
            connection.exec_driver_sql(
                f"INSERT INTO audit ({columns}) VALUES ('{then}', '{who}', '', '', '', '')"
            )
    log = filled(engine)
    assert problem_of(log, tmp_path) == ""
    assert json.loads((tmp_path / HEAD).read_text())["id"] == 8
    with engine.begin() as connection:
        connection.exec_driver_sql("DROP TRIGGER audit_no_update")
        connection.exec_driver_sql("UPDATE audit SET who = 'three' WHERE id = 1")
    assert "row 3" in problem_of(log, tmp_path)


def _made(data: Path) -> None:
    """A service's folder with six rows."""
    data.mkdir()
    engine = open_database(f"sqlite:///{data / 'service.sqlite'}")
    filled(engine)
    engine.dispose()
    (data / "service.id").write_text("1" * 32)


def _past_the_guards(data: Path, change: str) -> None:
    with sqlite3.connect(data / "service.sqlite") as connection:
        for verb in ("update", "delete"):
            connection.execute(f"DROP TRIGGER audit_no_{verb}")
        connection.execute(change)
    connection.close()


def _verified(data: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*HIL, "evidence", "verify", str(data)], capture_output=True, text=True, check=False
    )


def _until_told(service: Served) -> None:
    for _ in range(100):
        if service.get("/health")["audit_problem"]:
            return
        time.sleep(0.05)
    raise AssertionError("nothing is shown")
