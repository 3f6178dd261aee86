"""`hil check`: everything that can be known of a plan before a bench is touched."""

from __future__ import annotations

import datetime
import tempfile
from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from hil.cli._output import console, print_json, progress
from hil.core.channels import CHANNELS
from hil.engine import DEFAULT_BENCH, load_bench
from hil.engine.forecast import forecast
from hil.engine.preflight import preflight
from test_plans import Pace, estimate_duration_s, load_plan


def command(
    plan: Annotated[str, typer.Argument(help="plan file, or the name of a shipped plan")],
    bench: Annotated[str, typer.Option(help="bench file, or the name of a shipped bench")] = DEFAULT_BENCH,
    as_json: Annotated[
        bool, typer.Option("--json", help="print a JSON object on stdout, nothing else")
    ] = False,
) -> int:
    """Validate a plan, estimate its duration, predict its peaks by simulation, compare with the limits.

    Exit code: 0 it fits the bench, 1 a predicted peak is beyond a limit, 2 it cannot be run at all.
    """
    checked, file = load_plan(plan), load_bench(bench)
    with tempfile.TemporaryDirectory() as directory:
        preflight(checked, file, Path(directory), datetime.datetime.now(datetime.UTC).date())
    pace = Pace(speed_ramp_m_s2=file.dyno.speed_ramp_m_s2, wheel_radius_m=file.vehicle.wheel_radius_m)
    duration_s = estimate_duration_s(checked, pace)
    with progress(checked.name) as show:
        show("predicting by simulation")
        predicted = forecast(checked, file)
    fits = all(value <= limit for value, limit in predicted.values())
    if as_json:
        print_json(
            {
                "plan": checked.name,
                "bench": file.name,
                "fits": fits,
                "duration_s": round(duration_s, 1),
                "steps": len(checked.steps),
                "segments": [segment.id for segment in checked.segments],
                "criteria": len(checked.criteria),
                "predicted": {name: {"value": v, "limit": limit} for name, (v, limit) in predicted.items()},
            }
        )
        return 0 if fits else 1
    page = console()
    page.print(
        f"{checked.name}: valid, {len(checked.steps)} steps, {len(checked.segments)} segments, "
        f"{len(checked.criteria)} criteria, about {duration_s:.0f} s on the bench '{file.name}'",
        highlight=False,
    )
    page.print(_table(predicted))
    page.print("\nfits the bench" if fits else "\n[bold red]beyond the bench's limits[/]", highlight=False)
    return 0 if fits else 1


def _table(predicted: dict[str, tuple[float, float]]) -> Table:
    table = Table(
        box=None, pad_edge=False, header_style="bold", title="predicted by simulation", title_justify="left"
    )
    table.add_column("channel")
    for name in ("peak", "limit", "used"):
        table.add_column(name, justify="right")
    table.add_column("unit")
    for name, (value, limit) in predicted.items():
        used = f"{value / limit:.0%}"
        style = "" if value <= limit else "bold red"
        table.add_row(name, f"{value:.4g}", f"{limit:.4g}", used, CHANNELS[name].unit, style=style)
    return table
