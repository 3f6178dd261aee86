"""`hil run`: a plan on a bench, with its recording and reports."""

from __future__ import annotations

import sys
from pathlib import Path

from hil.cli._browser import show_in_browser
from hil.cli._choices import all_choices
from hil.cli._default_bench import bench_or_own
from hil.cli._one_run import Runs
from hil.cli._output import (
    console,
    count_in_words,
    expiry_in_words,
    print_criteria,
    print_json,
    told_identities,
    warn,
)
from hil.cli._series import announce_series, carry_out_series, repeated
from hil.cli._timing import times_in_words, timing_in_words
from hil.core.errors import BadInputError
from hil.core.model import load_model
from hil.core.printable import printable
from hil.core.result import RunResult
from hil.engine import DEFAULT_BENCH, load_bench
from test_plans import Plan, load_plan


def carry_out(
    *,
    plan: str,
    bench: str,
    out: Path | None,
    model: Path | None,
    values: list[str] | None,
    repeat: int,
    controller: list[str] | None,
    operator: str,
    yes: str,
    confirm: str,
    accept_expired: str,
    overwrite: bool,
    server: str,
    show: bool,
    as_json: bool,
) -> int:
    """Carry the command out; its exit code."""
    choices = list(all_choices(values, controller))
    if server:
        _refuse_here_only(model=model, controller=controller, repeat=repeat * len(choices), confirm=confirm)
        from hil.cli._remote_run import RemoteRun  # costs a run here nothing

        remote = RemoteRun(
            server, plan, bench or DEFAULT_BENCH, dict(choices[0].values), yes, accept_expired, overwrite
        )
        return remote.carry_out(out, lambda result, folder: _tell(result, folder, show=show, as_json=as_json))
    plans = [load_plan(plan, choice) for choice in choices]
    bench_file = load_bench(bench_or_own(bench, plan, drives=True))
    inputs = [bench_file.source, *([Path(plan)] if Path(plan).is_file() else []), *([model] if model else [])]
    runs = Runs(
        model=load_model(model) if model else None,
        operator=operator,
        confirmed_by=yes,
        hazard_confirmed_by=confirm or _asked_for_name(plans[0]),
        accept_expired=accept_expired,
        inputs=(*inputs, *choices[0].controllers.values()),
        overwrite=overwrite,
    )
    if len(plans) * repeat > 1:
        announce_series(plans, repeat, out)
        return carry_out_series(runs, plans, repeated(bench_file, repeat), out, as_json=as_json)
    with runs.finished(plans[0], bench_file, out) as run:
        _tell(run.result, run.folder, show=show, as_json=as_json)
        return run.exit_code


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


def _tell(result: RunResult, folder: Path, *, show: bool, as_json: bool) -> None:
    if as_json:
        print_json(result.model_dump(mode="json"))
    else:
        _print(result, folder)
    if show and "html" in result.files:
        show_in_browser(folder / result.files["html"])


def _asked_for_name(plan: Plan) -> str:
    """Who takes a hazardous plan upon them; asked before anything of the bench is opened."""
    if not plan.hazardous or not sys.stdin.isatty():
        return ""
    why = f": {printable(plan.hazardous, 500)}" if isinstance(plan.hazardous, str) else ""
    print(f"The plan {plan.name} is hazardous{why}\nYour name, to carry it out:", file=sys.stderr)
    return sys.stdin.readline().strip()


def _carried_out(result: RunResult) -> str:
    """What a run did that judged nothing."""
    count = sum(segment.complete for segment in result.segments)
    whole = "1 segment" if count == 1 else f"{count} segments"
    return f"{whole} recorded, " if result.verdict == "done" else ""


def _print(result: RunResult, folder: Path) -> None:
    page = console()
    if result.criteria:
        print_criteria(page, result.criteria)
    page.print(
        f"\n{result.plan} on {result.bench}: [bold]{result.verdict.upper()}[/], "
        f"{_carried_out(result)}{count_in_words(result.criteria)}   "
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
    said = told_identities(result.identities)
    if said:
        page.print(f"devices: {said}", highlight=False, markup=False, soft_wrap=True)
    shown = "html" if "html" in result.files else "recording"
    page.print(f"{'report' if shown == 'html' else shown}: {folder / result.files[shown]}", highlight=False)
