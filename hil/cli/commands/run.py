"""`hil run`: a plan on a bench, with its recording and reports."""

from __future__ import annotations

import sys
import tempfile
from dataclasses import replace
from pathlib import Path

from hil.app.again import UNPACKED, EarlierRun, compared_in_words, earlier_run
from hil.app.run import FinishedRun, RunSettings
from hil.app.series import announce_series, repeated, run_series
from hil.cli.inputs import named_values
from hil.cli.options.runs import Run
from hil.cli.output import (
    TERMINAL,
    console,
    count_in_words,
    expiry_in_words,
    identities_in_words,
    print_criteria,
    print_json,
    warn,
)
from hil.cli.run_inputs import all_choices, bench_or_own
from hil.cli.run_output import print_in_series, print_series, show_in_browser, times_in_words, timing_in_words
from hil.cli.streams import complain
from hil.core.errors import BadInputError
from hil.core.errors.wording import printable
from hil.core.model import load_model
from hil.core.result import RunResult
from hil.engine import DEFAULT_BENCH, BenchFile, load_bench
from test_plans import Plan, load_plan


def execute(options: Run) -> int:
    """Execute the command; its exit code."""
    if options.again is not None:
        return _execute_again(options, options.again)
    if not options.plan:
        fix = "name a plan (`hil list plans`), or an earlier run by --again"
        raise BadInputError("nothing to run is named", where="plan", fix=fix)
    return _execute(options)


def _execute_again(options: Run, run: Path) -> int:
    """An earlier run once more, with what is stored of it."""
    for option, given in {"a plan": options.plan, "--server": options.server}.items():
        if given:
            raise BadInputError(f"{option} does not go with --again", where="--again", fix="leave it out")
    with tempfile.TemporaryDirectory(prefix=UNPACKED) as folder:
        before = earlier_run(run, Path(folder))
        if before.bench is None and not options.bench:
            fix = "name the bench's file of today with --bench: limits and calibrations may have changed"
            raise BadInputError("ran on hardware, which is not driven unnamed", where=str(run), fix=fix)
        for text in before.changes or ("software and files are those of the earlier run",):
            complain("note", text)
        chosen = named_values(options.values or (), "--set")
        values = {name: f"{value!r}" for name, value in before.values.items()} | chosen
        unpacked = replace(
            options,
            plan=str(before.plan),
            bench=options.bench or str(before.bench),
            values=[f"{name}={value}" for name, value in values.items()],
        )
        try:
            return _execute(unpacked, before)
        except BadInputError as error:  # the folder is gone when somebody reads of it
            where = error.where.replace(folder, str(run))
            raise BadInputError(error.what, where=where, fix=error.fix) from error


def _execute(options: Run, before: EarlierRun | None = None) -> int:
    choices = list(all_choices(options.values, options.controller))
    if options.server:
        _refuse_here_only(
            model=options.model,
            controller=options.controller,
            repeat=options.repeat * len(choices),
            confirm=options.confirm,
        )
        from hil.cli.remote_run import RemoteRun  # costs a run here nothing

        remote = RemoteRun(
            options.server,
            options.plan,
            options.bench or DEFAULT_BENCH,
            dict(choices[0].values),
            options.yes,
            options.accept_expired,
            options.overwrite,
        )
        return remote.execute(
            options.out,
            lambda result, folder: _print_run(result, folder, show=options.show, as_json=options.as_json),
        )
    plans = [load_plan(options.plan, choice) for choice in choices]
    bench = load_bench(bench_or_own(options.bench, options.plan, drives=True))
    inputs = [
        bench.source,
        *([Path(options.plan)] if Path(options.plan).is_file() else []),
        *([options.model] if options.model else []),
        *([before.recording] if before is not None else []),
    ]
    settings = RunSettings(
        model=load_model(options.model) if options.model else None,
        operator=options.operator,
        confirmed_by=options.yes,
        hazard_confirmed_by=options.confirm or _asked_for_name(plans[0]),
        accept_expired=options.accept_expired,
        inputs=(*inputs, *choices[0].controllers.values()),
        overwrite=options.overwrite,
        feedback=TERMINAL,
    )
    if len(plans) * options.repeat > 1:
        return _run_series(options, settings, plans, bench)
    with settings.execute(plans[0], bench, options.out) as run:
        _print_run(run.result, run.folder, show=options.show, as_json=options.as_json)
        if before is not None:
            complain("note", compared_in_words(before.result, run.result))
        return run.exit_code


def _run_series(options: Run, settings: RunSettings, plans: list[Plan], bench: BenchFile) -> int:
    announce_series(plans, options.repeat, options.out, TERMINAL)

    def print_run(run: FinishedRun) -> None:
        if not options.as_json:
            print_in_series(run)

    outcome = run_series(settings, plans, repeated(bench, options.repeat), options.out, print_run)
    if options.as_json:
        print_json(outcome.summary)
    else:
        print_series(outcome.summary, outcome.folder)
    return outcome.exit_code


def _refuse_here_only(*, model: Path | None, controller: list[str] | None, repeat: int, confirm: str) -> None:
    """A service takes plans as they are, one at a time, and asks a second person for hazardous ones.

    Raises:
        BadInputError: names the option.
    """
    here_only = {
        "--model": model,
        "--controller": controller,
        "--repeat, or --set with several values,": repeat > 1,
        "--confirm": confirm,
    }
    for option, given in here_only.items():
        if given:
            raise BadInputError(
                f"{option} does not go with --server", where="--server", fix="leave one of them out"
            )


def _print_run(result: RunResult, folder: Path, *, show: bool, as_json: bool) -> None:
    if as_json:
        print_json(result.model_dump(mode="json"))
    else:
        _print_result(result, folder)
    if show and "html" in result.files:
        show_in_browser(folder / result.files["html"])


def _asked_for_name(plan: Plan) -> str:
    """Who takes a hazardous plan upon them; asked before anything of the bench is opened."""
    if not plan.hazardous or not sys.stdin.isatty():
        return ""
    why = f": {printable(plan.hazardous, 500)}" if isinstance(plan.hazardous, str) else ""
    print(f"The plan {plan.name} is hazardous{why}\nYour name, to execute it:", file=sys.stderr)
    return sys.stdin.readline().strip()


def _recorded_in_words(result: RunResult) -> str:
    """What a run did that judged nothing."""
    count = sum(segment.complete for segment in result.segments)
    whole = "1 segment" if count == 1 else f"{count} segments"
    return f"{whole} recorded, " if result.verdict == "done" else ""


def _print_result(result: RunResult, folder: Path) -> None:
    page = console()
    if result.criteria:
        print_criteria(page, result.criteria)
    page.print(
        f"\n{result.plan} on {result.bench}: [bold]{result.verdict.upper()}[/], "
        f"{_recorded_in_words(result)}{count_in_words(result.criteria)}   "
        f"safe state {result.safe_state.replace('_', ' ')}   "
        f"{result.bench_time_s:.0f} s of bench time, {times_in_words(result.real_time_factor)} x real time",
        highlight=False,
    )
    for line in timing_in_words(result.timing):
        page.print(line, highlight=False)
    for limit in result.limits:
        if limit.reached:
            times = "once" if limit.reached == 1 else f"{limit.reached} times"
            warn(f"limit {limit.name} was reached {times}; response: {limit.response}")
    for text in (*result.missing, *(f"not checked: {text}" for text in result.not_checked)):
        warn(text)
    if result.accepted_expired:
        warn(expiry_in_words(result.accepted_expired))
    devices = identities_in_words(result.identities)
    if devices:
        page.print(f"devices: {devices}", highlight=False, markup=False, soft_wrap=True)
    shown = "html" if "html" in result.files else "recording"
    page.print(f"{'report' if shown == 'html' else shown}: {folder / result.files[shown]}", highlight=False)
