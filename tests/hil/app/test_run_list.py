"""Runs below a folder, chosen and sorted by what their results say."""

from __future__ import annotations

import datetime
import json
from pathlib import Path

import pytest

from hil.app.run_list import RunsWanted, find_runs
from hil.core.errors import BadInputError
from hil.core.result import CriterionResult, RunResult


def put(
    folder: Path,
    day: int,
    peak: float | None,
    *,
    plan: str = "steps",
    verdict: str = "pass",
    bench: str = "sim",
) -> Path:
    """A run of a day in November with a peak against 250 N m and an energy against 1."""
    criteria = [CriterionResult(id="s.energy", value=0.4, unit="1", upper=1.0, verdict="pass")]
    if peak is not None:
        criteria += [CriterionResult(id="s.peak", value=peak, unit="N m", upper=250.0, verdict="pass")]
    result = RunResult(
        verdict=verdict,  # type: ignore[arg-type]
        plan=plan,
        bench=bench,
        started_at=f"2026-11-{day:02d}T12:00:00+00:00",
        real_time_factor=1.0,
        bench_time_s=1.0,
        safe_state="confirmed",
        criteria=tuple(criteria),
    )
    folder.mkdir(parents=True)
    (folder / "result.json").write_text(result.model_dump_json())
    return folder


@pytest.fixture
def runs(tmp_path: Path) -> Path:
    put(tmp_path / "a", 1, 240.0)
    put(tmp_path / "deep/er/b", 2, 200.0, bench="rear")
    put(tmp_path / "c", 3, 260.0, verdict="fail")
    put(tmp_path / "d", 4, None, plan="chirps", verdict="error")
    return tmp_path


def names(folder: Path, **wanted: object) -> list[str]:
    return [run.folder.name for run in find_runs(folder, RunsWanted(**wanted)).runs]  # type: ignore[arg-type]


def test_the_newest_stands_first_and_margins_are_of_the_worst_criterion(runs: Path) -> None:
    found = find_runs(runs, RunsWanted())
    assert [run.folder.name for run in found.runs] == ["d", "c", "b", "a"]
    assert found.runs[1].margin == pytest.approx(-0.04)
    assert found.runs[1].worst is not None
    assert found.runs[1].worst.id == "s.peak"
    assert found.runs[0].margin == pytest.approx(0.6)
    assert (found.total, found.read, found.unread) == (4, 4, ())


def test_filters_and_orders(runs: Path) -> None:
    assert names(runs, plan=("steps",), rising=True) == ["a", "b", "c"]
    assert names(runs, bench=("rear",)) == ["b"]
    assert names(runs, verdict=("fail", "error")) == ["d", "c"]
    day = datetime.datetime(2026, 11, 3, tzinfo=datetime.UTC)
    assert names(runs, since=day) == ["d", "c"]
    assert names(runs, until=day) == ["b", "a"]
    assert names(runs, criterion="s.peak", sort="value") == ["c", "a", "b"]
    assert names(runs, criterion="s.peak", above=240.0) == ["c", "a"]
    assert names(runs, criterion="s.peak", above=201.0, below=240.0) == ["a"]
    assert names(runs, sort="margin", rising=True)[0] == "c"
    assert names(runs, sort="run", rising=True) == ["a", "c", "d", "b"]


def test_a_page_says_how_many_there_are(runs: Path) -> None:
    found = find_runs(runs, RunsWanted(most=1))
    assert len(found.runs) == 1
    assert found.total == 4


@pytest.mark.parametrize("text", ["", "[", "[]", "5", '{"verdict": 1, "plan": 2, "criteria": 3}'])
def test_a_damaged_result_is_left_out_and_named(runs: Path, text: str) -> None:
    (runs / "e").mkdir()
    (runs / "e/result.json").write_text(text)
    found = find_runs(runs, RunsWanted())
    assert found.unread == (runs / "e/result.json",)
    assert found.total == 4


def test_a_file_of_that_name_that_is_none_is_no_run(runs: Path) -> None:
    (runs / "e").mkdir()
    (runs / "e/result.json").write_text(json.dumps({"score": 5}))
    found = find_runs(runs, RunsWanted())
    assert (found.total, found.unread) == (4, ())


@pytest.mark.parametrize(
    ("wanted", "said"),
    [
        ({"verdict": ("passed",)}, "there is no verdict 'passed'"),
        ({"sort": "date"}, "there is no order 'date'"),
        ({"sort": "value"}, "a value is that of a criterion"),
        ({"above": 1.0}, "a bound needs a criterion"),
        ({"criterion": "s.peek"}, "no run has the criterion 's.peek'"),
        ({"plan": ("acceptence",)}, "no run has the plan 'acceptence'"),
        ({"bench": ("nowhere",)}, "no run has the bench 'nowhere'"),
    ],
)
def test_what_cannot_be_meant_is_refused(runs: Path, wanted: dict[str, object], said: str) -> None:
    with pytest.raises(BadInputError, match=said):
        find_runs(runs, RunsWanted(**wanted))  # type: ignore[arg-type]


def test_a_folder_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BadInputError, match="is not a folder"):
        find_runs(tmp_path / "nowhere", RunsWanted())
    assert find_runs(tmp_path, RunsWanted()).read == 0
