"""`hil check`: everything that can be known of a plan before a bench is touched."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

from rich.table import Table

from hil.app.check import Checked, check_plan
from hil.app.requests import CheckRequest
from hil.cli.inputs import request_of
from hil.cli.options.runs import Check
from hil.cli.output import TERMINAL, console, plain_table, print_criteria, print_json, warn
from hil.cli.run_inputs import bench_or_own, choices_of
from hil.core.channels import CHANNELS
from hil.core.errors.wording import share
from hil.engine.prediction.forecast import Forecast

if TYPE_CHECKING:
    from hil.analysis.control_design import Margins


def execute(options: Check) -> int:
    """Execute the command; its exit code."""
    choices = choices_of(options.values, options.controller)
    bench = bench_or_own(options.bench, options.plan)
    checked = check_plan(request_of(CheckRequest, options, choices=choices, bench=bench), TERMINAL)
    if options.as_json:
        print_json(checked.as_json())
    else:
        _print(checked)
    for text in checked.warnings:
        warn(text)
    return 0 if checked.forecast.fits else 1


def _print(checked: Checked) -> None:
    plan, predicted, loops = checked.plan, checked.forecast, checked.loops
    page = console()
    page.print(
        f"{plan.name}: valid, {len(plan.steps)} steps, {len(plan.segments)} segments, "
        f"{len(plan.criteria)} criteria, about {predicted.duration_s:.0f} s on the bench '{checked.bench}'",
        highlight=False,
    )
    page.print(_table(predicted.peaks))
    loads = ", ".join(f"'{name}' at most {load:.0%}" for name, load in predicted.bus_loads.items())
    page.print(f"\nload of bus {loads}", highlight=False)
    if loops:
        page.print()
        page.print(_margins(loops))
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
        unknown = sum(criterion.verdict == "error" for criterion in asked)
        if unknown:
            verdict += f"; [bold red]{unknown} of {len(asked)} {name} cannot be computed[/]"
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


def _margins(found: Mapping[str, Margins]) -> Table:
    """A row a controller."""
    table = plain_table("speed loop on the bench's model")
    table.add_column("controller")
    for name in ("gain margin", "phase margin", "delay margin", "|S|max", "at"):
        table.add_column(name, justify="right")
    for name, one in found.items():
        if not one.stable:
            table.add_row(name, "unstable", "", "", "", "", style="bold red")
            continue
        table.add_row(
            name,
            _number(one.gain_margin_db, "dB"),
            _number(one.phase_margin_deg, "°"),
            _delay(one.delay_margin_s),
            f"{one.sensitivity_peak:.3g}",
            f"{one.sensitivity_peak_hz:.3g} Hz",
        )
    return table


def _delay(seconds: float) -> str:
    return _number(1e3 * seconds, "ms") if seconds < 1.0 else _number(seconds, "s")


def _number(value: float, unit: str) -> str:
    return f"{value:.3g} {unit}" if math.isfinite(value) else "no crossing"
