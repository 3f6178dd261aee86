"""`hil design`: from a model to a controller, with margins and figures."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hil.cli.completion import shipped_model
from hil.cli.options._shared import found_model


@dataclass(frozen=True, kw_only=True)
class Design:
    """Design a controller for a model: gains, lead or notch, filters, margins, sensitivity."""

    model: Annotated[
        Path,
        typer.Option(
            "--model",
            help="model file of any kind, or the name of a shipped model",
            callback=found_model,
            autocompletion=shipped_model(),
        ),
    ]
    out: Annotated[
        Path | None,
        typer.Option("--out", help="directory for the results; default: out/design-001 and so on"),
    ] = None
    optimize: Annotated[
        bool, typer.Option("--optimize", help="optimise lead and pole for the lowest sensitivity in 8-20 Hz")
    ] = False
    objective: Annotated[str, typer.Option("--objective", help="what --optimize minimises: max or rms")] = (
        "max"
    )
    lead_deg: Annotated[float, typer.Option("--lead-deg", help="phase lead P_h, degrees (equation 6)")] = 36.0
    lead_hz: Annotated[
        float, typer.Option("--lead-hz", help="centre frequency of the lead f_ph, Hz (equation 7)")
    ] = 40.0
    normalisation: Annotated[
        str,
        typer.Option(
            "--normalisation", help="frequency at which the lead has unity gain: dc, centre or high_frequency"
        ),
    ] = "high_frequency"
    notch_hz: Annotated[
        float | None,
        typer.Option(
            "--notch-hz", help="use a notch at this frequency, Hz, instead of the lead (equation 8)"
        ),
    ] = None
    notch_width: Annotated[
        float, typer.Option("--notch-width", help="damping ζ of the notch (equation 8)")
    ] = 2.0
    notch_depth: Annotated[float, typer.Option("--notch-depth", help="depth d of the notch (equation 8)")] = (
        0.08
    )
    pole: Annotated[float, typer.Option("--pole", help="pole p of the observer, rad/s (equations 4, 5)")] = (
        0.3
    )
    inertia: Annotated[
        float | None,
        typer.Option("--inertia", help="J_l/N² + J_m, kg m² (equations 4, 5); default: the model's"),
    ] = None
    gear_ratio: Annotated[
        float | None, typer.Option("--gear-ratio", help="gear ratio N of the observer; default: the model's")
    ] = None
    wheel_inertia: Annotated[
        float | None, typer.Option("--wheel-inertia", help="J_l, wheels and dyno rotors, kg m² (equation 9)")
    ] = None
    torque_limit: Annotated[float, typer.Option("--torque-limit", help="largest motor torque, N m")] = 150.0
    largest_sensitivity: Annotated[
        float, typer.Option("--largest-sensitivity", help="upper limit of |S| for --optimize")
    ] = 1.8
    frf: Annotated[
        Path | None, typer.Option("--frf", help="measured responses; default: frf.csv beside the model")
    ] = None
    name: Annotated[str, typer.Option("--name", help="name of the controller")] = ""
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace an earlier design in --out")] = False
    json_: Annotated[bool, typer.Option("--json", help="print design.json on stdout, nothing else")] = False
