"""The list of all runs: every filter, every order, pages that neither repeat nor leave out."""

from __future__ import annotations

import datetime
from pathlib import Path

import alembic.command
import alembic.config
import pytest
from sqlalchemy import Engine, create_engine, insert, text
from sqlalchemy.orm import sessionmaker

from hil.api_schemas.run_list import RunsWanted
from hil.service.store import Base, RunList, open_database

_RUNS, _CRITERIA = Base.metadata.tables["runs"], Base.metadata.tables["criteria"]
_BEGAN = datetime.datetime(2026, 1, 1, tzinfo=datetime.UTC)
_VERDICTS = ("pass", "fail", None)


def a_run(number: int, **more: object) -> dict[str, object]:
    empty = ("plan_source", "hazard", "confirmed_by", "accept_expired", "approved_by", "reason", "service")
    return {
        **dict.fromkeys(empty, ""),
        "id": number,
        "plan": f"plan-{number % 2}",
        "title": f"Title {number}",
        "plan_text": "name: p",
        "bench": f"bench-{number % 3}",
        "state": "ended" if _VERDICTS[number % 3] else "queued",
        "verdict": _VERDICTS[number % 3],
        "values_json": "{}",
        "priority": 0,
        "requested_by": "anna" if number < 5 else "bert",
        "queued_at": _BEGAN + datetime.timedelta(days=number),
        "ended_at": _BEGAN + datetime.timedelta(days=number) if _VERDICTS[number % 3] else None,
        "dut": f"axle {number // 4}",
    } | more


def a_criterion(run: int, value: float | None, name: str = "s.peak") -> dict[str, object]:
    return {
        "run": run,
        "id": name,
        "value": value,
        "unit": "N m",
        "upper": 9.0,
        "verdict": "pass",
        "dut": "axle",
    }


@pytest.fixture
def listed(engine: Engine) -> RunList:
    with sessionmaker(engine).begin() as session:
        session.execute(insert(_RUNS), [a_run(number) for number in range(1, 11)])
        values = [4.0, 2.0, None, 8.0, 6.0]
        session.execute(insert(_CRITERIA), [a_criterion(run, value) for run, value in enumerate(values, 1)])
    return RunList(engine)


def found(listed: RunList, **wanted: object) -> list[int]:
    answer = listed.find(RunsWanted.model_validate(wanted))
    assert answer.total >= len(answer.runs)
    return [one.run.id for one in answer.runs]


def test_without_filters_all_come_newest_first(listed: RunList) -> None:
    assert found(listed) == list(range(10, 0, -1))
    assert found(listed, rising=True) == list(range(1, 11))


@pytest.mark.parametrize(
    ("wanted", "runs"),
    [
        ({"plan": ["plan-1"]}, [9, 7, 5, 3, 1]),
        ({"bench": ["bench-0", "bench-1"], "plan": ["plan-0"]}, [10, 6, 4]),
        ({"verdict": ["fail"]}, [10, 7, 4, 1]),
        ({"state": ["queued"]}, [8, 5, 2]),
        ({"dut": ["axle 1"]}, [7, 6, 5, 4]),
        ({"requested_by": ["anna"], "verdict": ["pass"]}, [3]),
        ({"since": "2026-01-09T00:00:00Z"}, [10, 9, 8]),
        ({"until": "2026-01-04T00:00:00Z"}, [2, 1]),
        ({"since": "2026-01-09T00:00:00+02:00", "until": "2026-01-09T00:00:00Z"}, []),
        ({"text": "TITLE 1"}, [10, 1]),
        ({"text": "ber"}, [10, 9, 8, 7, 6, 5]),
        ({"text": "%"}, []),
        ({"criterion": "s.peak"}, [5, 4, 3, 2, 1]),
        ({"criterion": "s.peak", "above": 4.0}, [5, 4, 1]),
        ({"criterion": "s.peak", "above": 3.0, "below": 5.0}, [1]),
        ({"criterion": "other"}, []),
    ],
)
def test_each_filter_lets_the_right_runs_pass(
    listed: RunList, wanted: dict[str, object], runs: list[int]
) -> None:
    assert found(listed, **wanted) == runs
    assert listed.find(RunsWanted.model_validate(wanted)).total == len(runs)


@pytest.mark.parametrize(
    ("wanted", "runs"),
    [
        ({"sort": "plan", "rising": True}, [10, 8, 6, 4, 2, 9, 7, 5, 3, 1]),
        ({"sort": "verdict", "rising": True}, [10, 7, 4, 1, 9, 6, 3, 8, 5, 2]),
        ({"sort": "ended"}, [10, 9, 7, 6, 4, 3, 1, 8, 5, 2]),
        ({"sort": "value", "criterion": "s.peak"}, [4, 5, 1, 2, 3]),
        ({"sort": "value", "criterion": "s.peak", "rising": True}, [2, 1, 5, 4, 3]),
        ({"sort": "value"}, [10, 9, 8, 7, 6, 5, 4, 3, 2, 1]),
    ],
)
def test_each_order_has_what_has_no_value_last(
    listed: RunList, wanted: dict[str, object], runs: list[int]
) -> None:
    assert found(listed, **wanted) == runs


def test_the_longest_come_first_and_what_has_not_ended_last(engine: Engine) -> None:
    took_s = {1: 90.0, 2: 3601.5, 3: None, 4: 0.25, 5: 3601.25}
    began = _BEGAN + datetime.timedelta(hours=23, minutes=59)  # past midnight, too
    with sessionmaker(engine).begin() as session:
        for number, seconds in took_s.items():
            ended = None if seconds is None else began + datetime.timedelta(seconds=seconds)
            session.execute(insert(_RUNS), [a_run(number, started_at=began, ended_at=ended)])
    listed = RunList(engine)
    assert found(listed, sort="duration") == [2, 5, 1, 4, 3]
    assert found(listed, sort="duration", rising=True) == [4, 1, 5, 2, 3]


def test_pages_neither_repeat_nor_leave_out(listed: RunList) -> None:
    pages = [found(listed, sort="dut", first=first, most=3) for first in (0, 3, 6, 9, 12)]
    assert sorted(run for page in pages for run in page) == list(range(1, 11))
    assert [len(page) for page in pages] == [3, 3, 3, 1, 0]


def test_a_run_comes_with_the_criterion_asked_for(listed: RunList) -> None:
    (one,) = listed.find(RunsWanted(criterion="s.peak", above=7.0)).runs
    assert (one.run.id, one.value, one.unit, one.upper, one.criterion_verdict) == (4, 8.0, "N m", 9.0, "pass")
    assert listed.find(RunsWanted(most=1)).runs[0].value is None


def test_choices_are_what_there_is(listed: RunList) -> None:
    choices = listed.choices([])
    assert choices.benches == ["bench-0", "bench-1", "bench-2"]
    assert choices.people == ["anna", "bert"]
    assert choices.criteria == ["s.peak"]
    assert listed.choices(["plan-7"]).criteria == []


def test_runs_of_an_earlier_version_get_the_device_of_their_criteria(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path / 'service.sqlite'}"
    _earlier(url, "0007")
    engine = open_database(url)
    assert [(one.run.id, one.run.dut) for one in RunList(engine).find(RunsWanted()).runs] == [
        (2, ""),
        (1, "axle"),
    ]
    engine.dispose()


def _earlier(url: str, revision: str) -> None:
    import hil.service.store._opening as opening

    engine = create_engine(url)
    config = alembic.config.Config()
    config.set_main_option("script_location", str(opening._MIGRATIONS))
    config.set_main_option("path_separator", "os")
    with engine.begin() as connection:
        config.attributes["connection"] = connection
        alembic.command.upgrade(config, revision)
        for number in (1, 2):
            row = {name: value for name, value in a_run(number).items() if name != "dut"}
            row |= {"queued_at": "2026-01-01 00:00:00", "ended_at": None}
            names = ", ".join(row)
            marks = ", ".join(f":{name}" for name in row)
            connection.execute(text(f"INSERT INTO runs ({names}) VALUES ({marks})"), row)
        row = a_criterion(1, 4.0)
        connection.execute(
            text(f"INSERT INTO criteria ({', '.join(row)}) VALUES ({', '.join(f':{name}' for name in row)})"),
            row,
        )
    engine.dispose()


def test_words_are_looked_for_in_reasons_notes_and_tags_too(engine: Engine) -> None:
    notes, tags = Base.metadata.tables["notes"], Base.metadata.tables["tags"]
    with sessionmaker(engine).begin() as session:
        session.execute(
            insert(_RUNS), [a_run(1, reason="trip: shaft torque above 900 N m"), a_run(2), a_run(3)]
        )
        session.execute(insert(notes), [{"run": 3, "at": _BEGAN, "who": "anna", "text": "Belt was warm"}])
        session.execute(insert(tags), [{"run": 2, "tag": "axle-7", "who": "anna", "at": _BEGAN}])
    listed = RunList(engine)
    assert found(listed, text="SHAFT torque") == [1]
    assert found(listed, text="belt") == [3]
    assert found(listed, text="AXLE-7") == [2]
