"""Margins of the speed loop that each controller of a plan closes on the bench's model."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from rich.table import Table

from hil.cli._output import plain_table
from hil.core.controller import load_controller
from hil.core.model import load_model
from hil.engine import BenchFile, load_bench
from hil.engine.bench.bench_file import DEFAULT_BENCH
from hil.engine.prediction.batch_prediction import controller_files
from test_plans import Plan
from test_plans.steps import Step

if TYPE_CHECKING:
    from hil.analysis.control_design import Margins

#: A loop this close to -1 shakes with the next degree of temperature: 1 over it is the distance to -1.
_WARN_SENSITIVITY = 3.0


def loop_margins(plan: Plan, bench: BenchFile) -> dict[str, Margins]:
    """Of each controller file of a plan, by its name, on the bench's model or the shipped bench's."""
    from hil.analysis.tuning import SpeedLoops  # slow to load

    simulation = bench.simulation or load_bench(DEFAULT_BENCH).simulation
    assert simulation is not None, "the default bench is simulated"
    model = load_model(simulation.model)
    found = {}
    for file in controller_files(plan, bench):
        if Path(file).is_absolute():  # others are designed during the run
            controller = load_controller(file)
            found[file.stem] = SpeedLoops([model], controller.sample_time_s).margins(controller, 0)
    return found


def margins_table(found: dict[str, Margins]) -> Table:
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


def warnings_of(found: dict[str, Margins]) -> Iterable[str]:
    """What to say of loops that are not stable, or hardly."""
    for name, one in found.items():
        if not one.stable:
            yield f"controller '{name}': its speed loop is not stable on the bench's model"
        elif one.sensitivity_peak > _WARN_SENSITIVITY:
            yield (
                f"controller '{name}': its speed loop is close to instability, |S| = "
                f"{one.sensitivity_peak:.3g} at {one.sensitivity_peak_hz:.3g} Hz"
            )


def remarks_on_load(plan: Plan) -> Iterable[str]:
    """What to say of driving torque on wheels that the dynos hold: the table's loops are those of the car."""
    names = list(dict.fromkeys(_held(plan.steps)))
    if names:
        shown = ", ".join(f"'{name}'" for name in names[:5]) + (", …" if len(names) > 5 else "")
        yield (
            f"driving torque while the dynos hold the speed (load: speed, segment {shown}): the loop "
            "margins in the table apply to the vehicle only; driving force control then acts on wheels of "
            "fixed speed, see the predicted peaks"
        )


def _held(steps: Iterable[Step]) -> Iterator[str]:
    for step in steps:
        if getattr(step, "load", "") == "speed" and getattr(step, "quantity", "") == "driving_torque":
            yield from (segment.id for segment in step.segments())
        yield from _held(getattr(step, "steps", ()))


def margins_json(found: dict[str, Margins]) -> dict[str, dict[str, float | bool]]:
    """As numbers; infinite ones become null."""
    return {
        name: {
            "stable": one.stable,
            "gain_margin_db": one.gain_margin_db,
            "phase_margin_deg": one.phase_margin_deg,
            "delay_margin_s": one.delay_margin_s,
            "sensitivity_peak": one.sensitivity_peak,
            "sensitivity_peak_hz": one.sensitivity_peak_hz,
        }
        for name, one in found.items()
    }


def _delay(seconds: float) -> str:
    return _number(1e3 * seconds, "ms") if seconds < 1.0 else _number(seconds, "s")


def _number(value: float, unit: str) -> str:
    return f"{value:.3g} {unit}" if math.isfinite(value) else "no crossing"
