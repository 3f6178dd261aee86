"""`hil design`: from a model to a controller, with margins and figures."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from hil.cli._completion import shipped_model
from hil.cli.commands._options import found_model


def command(
    model: Annotated[
        Path,
        typer.Option(
            "--model",
            help="Model file of any kind, or the name of a shipped model.",
            callback=found_model,
            autocompletion=shipped_model(),
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option("--out", help="Directory for the results; default: out/design-001 and so on."),
    ] = None,
    optimize: Annotated[
        bool, typer.Option("--optimize", help="Search lead and pole for the lowest sensitivity in 8-20 Hz.")
    ] = False,
    objective: Annotated[
        str, typer.Option("--objective", help="What --optimize minimises: max or rms.")
    ] = "max",
    lead_deg: Annotated[float, typer.Option("--lead-deg", help="P_h of (6), degrees.")] = 36.0,
    lead_hz: Annotated[float, typer.Option("--lead-hz", help="f_ph of (7), Hz.")] = 40.0,
    normalisation: Annotated[
        str,
        typer.Option("--normalisation", help="Where the lead has gain one: dc, centre or high_frequency."),
    ] = "high_frequency",
    notch_hz: Annotated[
        float | None, typer.Option("--notch-hz", help="Notch at this frequency (8) instead of the lead.")
    ] = None,
    notch_width: Annotated[float, typer.Option("--notch-width", help="ζ of (8).")] = 2.0,
    notch_depth: Annotated[float, typer.Option("--notch-depth", help="d of (8).")] = 0.08,
    pole: Annotated[float, typer.Option("--pole", help="p of (4)(5), rad/s.")] = 0.3,
    inertia: Annotated[
        float | None, typer.Option("--inertia", help="J_l/N² + J_m of (4)(5), kg m²; default: the model's.")
    ] = None,
    gear_ratio: Annotated[
        float | None, typer.Option("--gear-ratio", help="N of the observer; default: the model's.")
    ] = None,
    wheel_inertia: Annotated[
        float | None, typer.Option("--wheel-inertia", help="J_l of (9), wheels and dyno rotors, kg m².")
    ] = None,
    torque_limit: Annotated[float, typer.Option("--torque-limit", help="Largest motor torque, N m.")] = 150.0,
    largest_sensitivity: Annotated[
        float, typer.Option("--largest-sensitivity", help="Limit of |S| for --optimize.")
    ] = 1.8,
    frf: Annotated[
        Path | None, typer.Option("--frf", help="Measured responses; default: frf.csv beside the model.")
    ] = None,
    name: Annotated[str, typer.Option("--name", help="Name of the controller.")] = "",
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Replace an earlier design in --out.")
    ] = False,
    json_: Annotated[bool, typer.Option("--json", help="Print design.json and nothing else.")] = False,
) -> int:
    """Gains, lead or notch, filters, Nyquist, sensitivity, margins and the trade-off chart for a model."""
    from hil.cli.design import carry_out

    return carry_out(
        model=model, out=out, optimize=optimize, objective=objective, lead_deg=lead_deg,
        lead_hz=lead_hz, normalisation=normalisation, notch_hz=notch_hz, notch_width=notch_width,
        notch_depth=notch_depth, pole=pole, inertia=inertia, gear_ratio=gear_ratio,
        wheel_inertia=wheel_inertia, torque_limit=torque_limit,
        largest_sensitivity=largest_sensitivity, frf=frf, name=name, overwrite=overwrite,
        json_=json_
    )  # fmt: skip
