"""Several runs of one plan: a run for each combination of its variables, each as often as asked for."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hil.app.feedback import Feedback
from hil.app.result_file import to_json
from hil.app.results_folder import results_in
from hil.app.run import FinishedRun, RunSettings
from hil.core.errors import BadInputError
from hil.core.files import write_atomically
from hil.core.result import RunResult
from hil.engine import BenchFile
from hil.engine.bench.bench_file import with_seed
from hil.engine.run.preflight import needed_bytes, refuse_too_little_room
from reports.series_report import SERIES_HTML, series_html
from test_plans import Plan, estimate_duration_s

SUMMARY = "series.json"
#: Runs of one series: some days at a bench.
LARGEST_SERIES = 1000
_BADNESS = ("informational", "pass", "did_not_settle", "undecided", "fail", "not_judged", "error")


@dataclass(frozen=True)
class SeriesOutcome:
    """What a series came to: series.json, its folder, and the largest exit code of its runs."""

    summary: dict[str, Any]
    folder: Path
    exit_code: int


def announce_series(plans: Sequence[Plan], repeat: int, out: Path | None, feedback: Feedback) -> None:
    """Report how many runs there will be, how long they take at a bench, and what they need.

    Raises:
        BadInputError: they are too many, or the disk has no room for them.
    """
    runs = len(plans) * repeat
    if runs > LARGEST_SERIES:
        raise BadInputError(
            f"{len(plans)} combinations, {repeat} times each, are {runs} runs: at most {LARGEST_SERIES} are "
            "executed",
            where="--repeat",
            fix="repeat fewer times, or simulate them with `hil campaign`",
        )
    refuse_too_little_room(plans, out or Path(), times=repeat)
    bench_time_s = repeat * sum(estimate_duration_s(plan) for plan in plans)
    size = repeat * sum(needed_bytes(plan) for plan in plans)
    feedback.note(
        f"{runs} runs, {bench_time_s / 60:.3g} min of bench time, at most {size / 1e9:.2g} GB on the disk"
    )


def repeated(bench: BenchFile, times: int) -> list[BenchFile]:
    """The bench for each repeat; a simulated one has noise of its own each time."""
    if bench.simulation is None or times == 1:
        return [bench] * times
    return [with_seed(bench, bench.simulation.seed + number) for number in range(times)]


def run_series(
    settings: RunSettings,
    plans: Sequence[Plan],
    benches: Sequence[BenchFile],
    out: Path | None,
    report_run: Callable[[FinishedRun], None],
) -> SeriesOutcome:
    """Carry every plan out on every bench, each in a numbered folder.

    A run that did not come to its end ends the series; what was executed so far is kept and summed up.

    Args:
        report_run: called after each run.
    """
    done: list[tuple[int, FinishedRun]] = []
    code = 0
    with results_in(
        out,
        (SUMMARY, SERIES_HTML),
        inputs=settings.inputs,
        overwrite=settings.overwrite,
        default=f"{plans[0].name}-series",
    ) as place:
        for number, (group, plan, bench) in enumerate(_each(plans, benches), 1):
            with settings.execute(plan, bench, place.folder / f"{number:03d}") as run:
                done.append((group, run))
                write_atomically(place.folder / SUMMARY, to_json(_summary(done)) + "\n")
                report_run(run)
                code = max(code, run.exit_code)
                if run.outcome.error is not None:
                    break
        summary = _summary(done)
        page = series_html(plans[0].title or plans[0].name, benches[0].name, summary)
        write_atomically(place.folder / SERIES_HTML, page)
    return SeriesOutcome(summary, place.folder, code)


def _each(plans: Sequence[Plan], benches: Sequence[BenchFile]) -> Iterator[tuple[int, Plan, BenchFile]]:
    for group, plan in enumerate(plans):
        for bench in benches:
            yield group, plan, bench


def _summary(done: Sequence[tuple[int, FinishedRun]]) -> dict[str, Any]:
    groups: dict[int, list[RunResult]] = {}
    for group, run in done:
        groups.setdefault(group, []).append(run.result)
    return {
        "runs": [
            {
                "folder": run.folder.name,
                "variables": _variables(run.result),
                "verdict": run.result.verdict,
                "report": f"{run.folder.name}/{run.result.files['html']}"
                if "html" in run.result.files
                else "",
                "criteria": {one.id: one.value for one in run.result.criteria},
            }
            for _, run in done
        ],
        "spread": [
            {"variables": _variables(results[0]), "criteria": _spread(results)} for results in groups.values()
        ],
    }


def _variables(result: RunResult) -> dict[str, float]:
    return {variable.name: variable.value for variable in result.variables}


def _spread(results: Sequence[RunResult]) -> dict[str, dict[str, Any]]:
    """Of each criterion: limits (null where they move), worst verdict, and how its values spread."""
    found = {}
    for criterion in results[0].criteria:
        of_runs = [one for result in results for one in result.criteria if one.id == criterion.id]
        values = [one.value for one in of_runs if one.value is not None]
        found[criterion.id] = {
            "unit": criterion.unit,
            "lower": _common(one.lower for one in of_runs),
            "upper": _common(one.upper for one in of_runs),
            "below": criterion.below,
            "verdict": max((one.verdict for one in of_runs), key=_BADNESS.index),
            "count": len(values),
            "mean": statistics.fmean(values) if values else None,
            "standard_deviation": statistics.stdev(values) if len(values) > 1 else None,
            "lowest": min(values, default=None),
            "highest": max(values, default=None),
        }
    return found


def _common(limits: Iterable[float | None]) -> float | None:
    """The limit that all runs have; None where it differs, as one does that another segment sets."""
    found = set(limits)
    return found.pop() if len(found) == 1 else None
