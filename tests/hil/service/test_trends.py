"""Trends: scatter from neighbours, distance to the nearer limit, and only what can be stated."""

from __future__ import annotations

import datetime
from pathlib import Path

import numpy as np
import pytest

from hil.api_schemas.api import RunState, TrendPoint
from hil.core.result import CriterionResult, RunResult
from hil.service.store import BenchStore, NewRun, RunStore, open_database
from hil.service.trends import LEAST_POINTS, trends

Points = list[tuple[str, TrendPoint]]


def points(values: list[float | None], *, upper: float | None = None, lower: float | None = None) -> Points:
    moment = datetime.datetime(2026, 1, 1, tzinfo=datetime.UTC)
    return [
        (
            "s.peak",
            TrendPoint(
                run=n + 1,
                ended_at=moment,
                dut="A",
                value=v,
                unit="N m",
                upper=upper,
                lower=lower,
                verdict="pass",
            ),
        )
        for n, v in enumerate(values)
    ]


def test_scatter_and_cpk_are_those_of_the_distribution() -> None:
    values = np.random.default_rng(3).normal(300.0, 5.0, 4000).tolist()
    (found,) = trends(points(values, upper=330.0, lower=200.0))
    assert found.deviation == pytest.approx(5.0, rel=0.03)
    assert found.cpk == pytest.approx(30.0 / 15.0, rel=0.05)  # the upper limit is nearer


@pytest.mark.parametrize("count", [12, 60])
def test_the_interval_of_cpk_has_the_true_one_as_often_as_it_says(count: int) -> None:
    draws, true = np.random.default_rng(5), 30.0 / 15.0
    inside = 0
    for _ in range(600):
        values = draws.normal(300.0, 5.0, count).tolist()
        (found,) = trends(points(values, upper=330.0))
        inside += found.cpk_lower <= true <= found.cpk_upper  # type: ignore[operator]
    assert found.count == count
    assert 0.90 < inside / 600 < 0.99


def test_a_drift_is_no_scatter() -> None:
    (found,) = trends(points([300.0 + n for n in range(100)], upper=500.0))
    assert found.deviation == pytest.approx(1 / 1.128)


def test_little_is_not_made_into_a_figure() -> None:
    (found,) = trends(points([1.0] * (LEAST_POINTS - 1), upper=2.0))
    assert (found.mean, found.deviation, found.cpk) == (1.0, None, None)
    assert (found.count, found.cpk_lower, found.cpk_upper) == (LEAST_POINTS - 1, None, None)
    (found,) = trends(points([1.0] * LEAST_POINTS, upper=2.0))
    assert (found.deviation, found.cpk) == (0.0, None)  # no scatter at all: no ratio
    (found,) = trends(points([1.0, 2.0, None, 1.0, 2.0, 1.0]))
    assert found.cpk is None  # no limit
    (found,) = trends(points([None]))
    assert found.mean is None
    assert trends([]) == []


def test_the_store_gives_the_newest_runs_of_a_plan_and_a_dut_oldest_first(tmp_path: Path) -> None:
    engine = open_database(f"sqlite:///{tmp_path / 'service.sqlite'}")
    runs = RunStore(engine)
    BenchStore(engine, "me").hold("sim")
    for number in range(6):
        run, _ = runs.add(NewRun("p", "P", "name: p", "p.yaml", "sim", {}, "anna"), approved=True)
        runs.take(run.id, "me")
        one = CriterionResult(id="s.peak", value=float(number), unit="N m", upper=9.0, verdict="pass")
        result = RunResult(
            verdict="pass", plan="p", bench="sim", real_time_factor=1.0, bench_time_s=1.0,
            safe_state="confirmed", criteria=(one,),
        )  # fmt: skip
        state: RunState = "interrupted" if number == 5 else "ended"
        runs.end(run.id, state, exit_code=0, result=result, dut="A" if number % 2 else "B")
    assert [point.value for _, point in runs.criteria("sim", "p", None, 3)] == [2.0, 3.0, 4.0]
    assert [point.value for _, point in runs.criteria("sim", "p", "A", 100)] == [1.0, 3.0]
    assert runs.criteria("other", "p", None, 3) == []
    cut, _ = runs.add(NewRun("p", "P", "name: p", "p.yaml", "sim", {}, "anna"), approved=True)
    runs.take(cut.id, "me")
    runs.end(cut.id, "ended", exit_code=3, result=result.model_copy(update={"verdict": "error"}), dut="A")
    assert [point.value for _, point in runs.criteria("sim", "p", "A", 100)] == [1.0, 3.0]
    run, _ = runs.add(NewRun("p", "P", "name: p # changed", "p.yaml", "sim", {}, "anna"), approved=True)
    runs.take(run.id, "me")
    runs.end(run.id, "ended", exit_code=0, result=result)
    assert [point.run for _, point in runs.criteria("sim", "p", None, 100)] == [run.id]
    assert [point.value for _, point in runs.criteria("sim", "p", "A", 100, like=2)] == [1.0, 3.0]
    assert runs.criteria("sim", "p", None, 100, like=run.id + 1) == []
