"""`hil check`: everything that can be known of a plan before a bench is touched."""

from __future__ import annotations

import datetime
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from rich.table import Table

from hil.cli._choices import choices_of
from hil.cli._default_bench import bench_or_own
from hil.cli._loop_margins import loop_margins, margins_json, margins_table, remarks_on_load, warnings_of
from hil.cli._output import console, plain_table, print_criteria, print_json, progress, warn
from hil.cli.commands.check import Check
from hil.core.channels import CHANNELS
from hil.core.digits import share
from hil.core.errors import BadInputError
from hil.core.extras import not_installed
from hil.core.mistakes import all_of
from hil.engine import BenchFile, load_bench
from hil.engine.bench.calibration_dates import accepted_expiry
from hil.engine.bench.measured import refuse_unmeasured
from hil.engine.prediction.forecast import Forecast, forecast
from hil.engine.run.preflight import preflight
from test_plans import Choices, Plan, load_plan

if TYPE_CHECKING:
    from hil.analysis.control_design import Margins


def carry_out(options: Check) -> int:
    """Carry the command out; its exit code."""
    choices = choices_of(options.values, options.controller)
    checked, file = _loaded(options.plan, choices, options.bench)
    with tempfile.TemporaryDirectory() as directory:
        today = datetime.datetime.now(datetime.UTC).date()
        accepted_expiry(file, today, "")
        preflight(checked, file, Path(directory))
    refuse_unmeasured(file)
    with progress(checked.name) as show:
        show("predicting")
        predicted = forecast(checked, file)
    try:
        loops = loop_margins(checked, file)
    except ModuleNotFoundError as error:
        missing = not_installed(error)
        if missing is None:
            raise
        warn(f"no margins of the loops: {missing}")
        loops = {}
    if options.as_json:
        print_json(_json(checked, file.name, predicted) | {"loops": margins_json(loops)})
    else:
        _tell(checked, file.name, predicted, loops)
    unjudged = (f"not checked: {text}" for text in checked.device_gaps)
    for text in (*warnings_of(loops), *remarks_on_load(checked), *unjudged):
        warn(text)
    return 0 if predicted.fits else 1


def _loaded(plan: str, choices: Choices, bench: str) -> tuple[Plan, BenchFile]:
    """Plan and bench file; what is wrong with either is told at once."""
    refused = []
    try:
        checked = load_plan(plan, choices)
    except BadInputError as error:
        refused.append(error)
    try:
        file = load_bench(bench_or_own(bench, plan))
    except BadInputError as error:
        refused.append(error)
    all_of(refused)
    return checked, file


def _json(plan: Plan, bench: str, predicted: Forecast) -> dict[str, object]:
    peaks = {name: {"value": value, "limit": limit} for name, (value, limit) in predicted.peaks.items()}
    return {
        "plan": plan.name,
        "bench": bench,
        "fits": predicted.fits,
        "duration_s": round(predicted.duration_s, 1),
        "steps": len(plan.steps),
        "segments": [segment.id for segment in plan.segments],
        "predicted": peaks,
        "bus_loads": {name: round(load, 4) for name, load in predicted.bus_loads.items()},
        "not_checked": list(plan.device_gaps),
        "criteria": [
            {**criterion.model_dump(exclude={"definition"}), "margin": criterion.margin}
            for criterion in predicted.criteria
        ],
    }


def _tell(plan: Plan, bench: str, predicted: Forecast, loops: dict[str, Margins]) -> None:
    page = console()
    page.print(
        f"{plan.name}: valid, {len(plan.steps)} steps, {len(plan.segments)} segments, "
        f"{len(plan.criteria)} criteria, about {predicted.duration_s:.0f} s on the bench '{bench}'",
        highlight=False,
    )
    page.print(_table(predicted.peaks))
    loads = ", ".join(f"'{name}' at most {load:.0%}" for name, load in predicted.bus_loads.items())
    page.print(f"\nload of bus {loads}", highlight=False)
    if loops:
        page.print()
        page.print(margins_table(loops))
    if predicted.criteria:
        page.print("\n[italic]criteria, predicted[/]")
        print_criteria(page, predicted.criteria)
    unstable = [name for name, one in loops.items() if not one.stable]
    page.print(f"\n{_verdict(predicted, unstable)}", highlight=False)


def _verdict(predicted: Forecast, unstable: list[str]) -> str:
    """What the exit code says, and what it does not."""
    verdict = "fits the bench" if predicted.fits else "[bold red]beyond the bench's limits[/]"
    if predicted.overloaded:
        names = ", ".join(f"'{name}'" for name in predicted.overloaded)
        verdict = f"[bold red]bus {names} cannot carry its frames; raise bit_rate[/]"
    for source, name in (("plan", "criteria"), ("device", "device checks")):
        asked = [criterion for criterion in predicted.criteria if criterion.source == source]
        failed = sum(criterion.failed for criterion in asked)
        if failed:
            verdict += f"; [bold red]{failed} of {len(asked)} {name} are predicted to fail[/]"
    if unstable:
        verdict += f"; [bold red]the loop of {' and '.join(unstable)} is not stable on the bench's model[/]"
    return verdict


def _table(peaks: dict[str, tuple[float, float]]) -> Table:
    table = plain_table("peaks, predicted")
    table.add_column("channel")
    for name in ("peak", "limit", "used"):
        table.add_column(name, justify="right")
    table.add_column("unit")
    for name, (value, limit) in peaks.items():
        used = share(value / limit, 0)
        style = "" if value <= limit else "bold red"
        table.add_row(name, f"{value:.4g}", f"{limit:.4g}", used, CHANNELS[name].unit, style=style)
    return table
