"""Several runs of one plan: a run for each combination of its variables, each as often as asked for."""

from __future__ import annotations

import statistics
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from hil.cli._choices import LARGEST_SERIES
from hil.cli._one_run import Finished, Runs
from hil.cli._output import console, count_in_words, note, plain_table, print_json, to_json
from hil.cli._results_folder import ResultsFolder, results_in
from hil.core.errors import BadInputError
from hil.core.files import write_atomically
from hil.core.result import RunResult
from hil.engine import BenchFile
from hil.engine.bench.bench_file import with_seed
from hil.engine.run.disk_room import needed_bytes, refuse_too_little_room
from reports.series_report import SERIES_HTML, limit_in_words, series_html, values_in_words
from test_plans import Plan, estimate_duration_s

SUMMARY = "series.json"
_BADNESS = ("informational", "pass", "did_not_settle", "undecided", "fail", "not_judged", "error")


def announce_series(plans: Sequence[Plan], repeat: int, out: Path | None) -> None:
    """Say on stderr how many runs there will be, how long they take at a bench, and what they need.

    Raises:
        BadInputError: they are too many, or the disk has no room for them.
    """
    runs = len(plans) * repeat
    if runs > LARGEST_SERIES:
        raise BadInputError(
            f"{len(plans)} combinations, {repeat} times each, are {runs} runs: at most {LARGEST_SERIES} are "
            "carried out",
            where="--repeat",
            fix="repeat fewer times, or simulate them with `hil campaign`",
        )
    refuse_too_little_room(plans, out or Path(), times=repeat)
    bench_time_s = repeat * sum(estimate_duration_s(plan) for plan in plans)
    size = repeat * sum(needed_bytes(plan) for plan in plans)
    note(f"{runs} runs, {bench_time_s / 60:.3g} min of bench time, at most {size / 1e9:.2g} GB on the disk")


def repeated(bench: BenchFile, times: int) -> list[BenchFile]:
    """The bench for each repeat; a simulated one has noise of its own each time."""
    if bench.simulation is None or times == 1:
        return [bench] * times
    return [with_seed(bench, bench.simulation.seed + number) for number in range(times)]


def carry_out_series(
    runs: Runs, plans: Sequence[Plan], benches: Sequence[BenchFile], out: Path | None, *, as_json: bool
) -> int:
    """Carry out every plan on every bench, each in a numbered folder; the largest exit code.

    A run that did not come to its end ends the series; what was carried out so far is kept and summed up.
    """
    done: list[tuple[int, Finished]] = []
    code = 0
    with results_in(
        out,
        (SUMMARY, SERIES_HTML),
        inputs=runs.inputs,
        overwrite=runs.overwrite,
        default=f"{plans[0].name}-series",
    ) as place:
        for number, (group, plan, bench) in enumerate(_each(plans, benches), 1):
            with runs.finished(plan, bench, place.folder / f"{number:03d}") as run:
                done.append((group, run))
                write_atomically(place.folder / SUMMARY, to_json(_summary(done)) + "\n")
                if not as_json:
                    _tell(run)
                code = max(code, run.exit_code)
                if run.outcome.error is not None:
                    break
        summary = _summary(done)
        page = series_html(plans[0].title or plans[0].name, benches[0].name, summary)
        write_atomically(place.folder / SERIES_HTML, page)
        _tell_all(summary, place, as_json=as_json)
    return code


def _each(plans: Sequence[Plan], benches: Sequence[BenchFile]) -> Iterator[tuple[int, Plan, BenchFile]]:
    for group, plan in enumerate(plans):
        for bench in benches:
            yield group, plan, bench


def _summary(done: Sequence[tuple[int, Finished]]) -> dict[str, Any]:
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


def _tell(run: Finished) -> None:
    values = ", ".join(map(str, run.result.variables))
    console().print(
        f"{run.folder.name}  {values}: [bold]{run.result.verdict.upper()}[/], "
        f"{count_in_words(run.result.criteria)}",
        highlight=False,
    )


def _tell_all(summary: dict[str, Any], place: ResultsFolder, *, as_json: bool) -> None:
    if as_json:
        print_json(summary)
        return
    table = plain_table()
    varied = any(group["variables"] for group in summary["spread"])
    if varied:
        table.add_column("variables")
    table.add_column("criterion", overflow="fold")
    table.add_column("limit", no_wrap=True)
    table.add_column("verdict", no_wrap=True)
    for name in ("runs", "mean", "std. dev.", "lowest", "highest"):
        table.add_column(name, justify="right", no_wrap=True, min_width=6)
    table.add_column("unit", no_wrap=True)
    for group in summary["spread"]:
        values = values_in_words(group["variables"])
        for number, (name, spread) in enumerate(group["criteria"].items()):
            numbers = (spread[key] for key in ("mean", "standard_deviation", "lowest", "highest"))
            cells = ("-" if value is None else f"{value:.4g}" for value in numbers)
            said = (name, limit_in_words(spread), spread["verdict"].replace("_", " "), str(spread["count"]))
            first = (values if number == 0 else "",) if varied else ()
            table.add_row(*first, *said, *cells, spread["unit"])
    page = console()
    page.print()
    page.print(table)
    page.print(f"\nsummary: {place.folder / SUMMARY}\nreport: {place.folder / SERIES_HTML}", highlight=False)
