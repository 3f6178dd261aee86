"""The best run by margins that are computed by hand."""

from __future__ import annotations

import asyncio
import json
from typing import Any, Literal

import pytest
from sqlalchemy import Engine

from hil.core.result import CriterionResult, CriterionVerdict, RunResult
from hil.service.best_run import best_run
from hil.service.store import NewRun, RunList, RunStore
from hil.service.worker_pool import WorkerPool
from hil.service.worker_pool._best_run import best


def criterion(
    id: str,
    value: float | None,
    upper: float | None = None,
    lower: float | None = None,
    verdict: CriterionVerdict = "pass",
) -> CriterionResult:
    return CriterionResult(id=id, value=value, unit="N m", upper=upper, lower=lower, verdict=verdict)


def of_two(peak: float, trough: float) -> list[CriterionResult]:
    """At most 500 N m, at least -40 N m."""
    return [criterion("s.peak", peak, upper=500.0), criterion("s.trough", trough, lower=-40.0)]


def test_the_best_has_the_largest_smallest_margin() -> None:
    # margins: run 1 (500 - 400) / 500 = 0.2 and (-20 + 40) / 40 = 0.5, smallest 0.2;
    # run 2 (500 - 350) / 500 = 0.3 and (-30 + 40) / 40 = 0.25, smallest 0.25;
    # run 3 (500 - 100) / 500 = 0.8 and (-36 + 40) / 40 = 0.1, smallest 0.1
    passed = {1: of_two(400, -20), 2: of_two(350, -30), 3: of_two(100, -36)}
    best, among = best_run(passed[1], passed)
    assert best is not None
    assert (best.run, best.criterion, among) == (2, "s.trough", 3)
    assert best.margin == pytest.approx(0.25)


def test_of_two_limits_the_nearer_counts_and_of_equals_the_newest() -> None:
    # 90 in 0 to 100 is 0.1 from the upper; the limit of zero has no share
    both = [criterion("s.x", 90.0, upper=100.0, lower=0.0)]
    best, _ = best_run(both, {4: both, 7: both, 5: both})
    assert best is not None
    assert (best.run, best.margin) == (7, pytest.approx(0.1))


def test_runs_with_other_limits_or_criteria_are_not_compared() -> None:
    mine = of_two(400, -20)
    others = {
        2: [criterion("s.peak", 100.0, upper=900.0), mine[1]],
        3: [mine[0]],
        4: [*mine, criterion("s.more", 1.0, upper=1000.0)],
    }
    assert best_run(mine, others) == (None, 0)
    assert best_run([criterion("s.peak", 1.0, verdict="informational")], {2: mine}) == (None, 0)


def test_checks_of_any_device_and_values_without_a_limit_do_not_count() -> None:
    more = [
        criterion("s.arrival", 9.9, upper=10.0, lower=-10.0),
        criterion("s.clunk", 5.0, verdict="informational"),
        criterion("s.settling_time", None, verdict="did_not_settle"),
    ]
    best, among = best_run(of_two(400, -20), {6: [*of_two(400, -20), *more]})
    assert best is not None
    assert (best.margin, among) == (pytest.approx(0.2), 1)


def test_a_relative_limit_differs_from_run_to_run_and_counts_with_its_own() -> None:
    # below another segment's 300 and 200: margins (300 - 270) / 300 = 0.1 and (200 - 120) / 200 = 0.4
    first = [criterion("a.peak.below.b", 270.0, upper=300.0)]
    other = [criterion("a.peak.below.b", 120.0, upper=200.0)]
    best, among = best_run(first, {1: first, 2: other})
    assert best is not None
    assert (best.run, best.margin, among) == (2, pytest.approx(0.4), 2)


_Run = tuple[float, str, str, dict[str, float]]


def beside(*runs: _Run) -> str:
    """As the database has it: the peak of each run, at most 500 N m, its plan, its bench, its values."""
    criteria = {
        number: [{"id": "s.peak", "value": peak, "unit": "N m", "upper": 500.0, "verdict": "pass"}]
        for number, (peak, *_) in enumerate(runs, 1)
    }
    settings = {
        number: (plan, bench, json.dumps(values)) for number, (_, plan, bench, values) in enumerate(runs, 1)
    }
    return json.dumps({"criteria": criteria, "settings": settings})


_USUAL = {"p": {"torque_nm": 100.0}}


def test_beside_a_failed_run_one_of_its_plan_bench_and_values_comes_before_a_better_one() -> None:
    runs: list[_Run] = [
        (600.0, "p", "sim", {"torque_nm": 100.0}),
        (50.0, "p", "sim", {"torque_nm": 20.0}),
        (400.0, "p", "sim", {}),  # the plan's own value, which is the first run's
        (60.0, "p", "other", {"torque_nm": 100.0}),
    ]
    found = best(1, passed=False, criteria=beside(*runs), usual=_USUAL)
    assert (found["run"], found["other_values"], found["among"]) == (3, {}, 1)
    found = best(1, passed=False, criteria=beside(*runs[:2]), usual=_USUAL)
    assert (found["run"], found["other_values"]) == (2, {"torque_nm": 20.0})


def test_beside_a_run_that_passed_too_those_of_its_plan_and_values_come_first() -> None:
    runs: list[_Run] = [
        (400.0, "p", "sim", {"torque_nm": 380.0}),
        (50.0, "p", "sim", {"torque_nm": 100.0}),  # far better, at less torque
        (300.0, "p", "other", {"torque_nm": 380.0}),
    ]
    found = best(1, passed=True, criteria=beside(*runs), usual=_USUAL)
    assert (found["run"], found["other_values"], found["among"]) == (3, {}, 2)
    found = best(3, passed=True, criteria=beside(*runs), usual=_USUAL)
    assert (found["run"], found["among"]) == (3, 2)
    found = best(2, passed=True, criteria=beside(*runs[:2]), usual=_USUAL)
    assert (found["run"], found["among"]) == (2, 2)


def test_a_run_that_passed_is_told_of_a_better_one_of_other_values_where_none_is_like_it() -> None:
    runs: list[_Run] = [(400.0, "p", "sim", {}), (50.0, "copy", "other", {"torque_nm": 20.0})]
    found = best(1, passed=True, criteria=beside(*runs), usual=_USUAL)
    assert (found["run"], found["other_values"]) == (2, {"torque_nm": 20.0})


@pytest.mark.slow
def test_another_process_finds_it_in_what_the_database_has_of_the_runs(engine: Engine) -> None:
    """The service's loop would stand still meanwhile."""
    runs = RunStore(engine)
    numbers = [_over(runs, peak) for peak in (400.0, 350.0, 100.0)]
    failed = _over(runs, 600.0, verdict="fail")
    listed = RunList(engine)

    async def ask(run: int, *, passed: bool) -> dict[str, Any]:
        pool = WorkerPool(niceness=0)
        try:
            return await pool.ask(
                "best_run", run=run, passed=passed, criteria=listed.criteria_beside(run), usual={}
            )
        finally:
            process = pool._process
            pool.close()
            if process is not None:
                await process.wait()

    best = asyncio.run(ask(numbers[0], passed=True))
    assert best == {
        "run": numbers[2],
        "margin": pytest.approx(0.8),
        "criterion": "s.peak",
        "among": 3,
        "other_values": {},
    }
    assert asyncio.run(ask(failed, passed=False)) == best
    assert json.loads(listed.criteria_beside(9999)) == {"criteria": {"9999": []}, "settings": {}}


def _over(runs: RunStore, peak: float, verdict: Literal["pass", "fail"] = "pass") -> int:
    run = runs.add(NewRun("p", "P", "name: p", "p.yaml", "sim", {}, "anna"), approved=True)[0].id
    assert runs.take(run, "me") is not None
    result = RunResult(
        verdict=verdict,
        plan="p",
        bench="sim",
        real_time_factor=1.0,
        bench_time_s=1.0,
        safe_state="confirmed",
        criteria=(criterion("s.peak", peak, upper=500.0, verdict=verdict),),
    )
    assert runs.end(run, "ended", result=result)
    return run
