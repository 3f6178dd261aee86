"""`hil design`: from a model to a controller, with margins and figures."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, get_args

import typer

from hil.analysis.control_design import DesignSpec, MarginLimits, Normalisation, Objective, design
from hil.analysis.frequency_response import frf_from_csv
from hil.analysis.outputs.control_design import output_files, summary_of, text_of
from hil.cli._output import print_json, progress, to_json
from hil.cli._place import results_in
from hil.core.errors import BadInputError
from hil.core.model import load_model

_PAPER = DesignSpec()


def command(
    model: Annotated[Path, typer.Option("--model", help="Model file of any kind.")],
    out: Annotated[Path, typer.Option("--out", help="Directory for the results.")],
    optimize: Annotated[
        bool, typer.Option("--optimize", help="Search lead and pole for the lowest sensitivity in 8-20 Hz.")
    ] = False,
    objective: Annotated[
        str, typer.Option("--objective", help="What --optimize minimises: max or rms.")
    ] = "max",
    lead_deg: Annotated[float, typer.Option("--lead-deg", help="P_h of (6), degrees.")] = _PAPER.lead_deg,
    lead_hz: Annotated[float, typer.Option("--lead-hz", help="f_ph of (7), Hz.")] = _PAPER.lead_hz,
    normalisation: Annotated[
        str,
        typer.Option("--normalisation", help="Where the lead has gain one: dc, centre or high_frequency."),
    ] = _PAPER.normalisation,
    notch_hz: Annotated[
        float | None, typer.Option("--notch-hz", help="Notch at this frequency (8) instead of the lead.")
    ] = None,
    notch_width: Annotated[float, typer.Option("--notch-width", help="ζ of (8).")] = _PAPER.notch_width,
    notch_depth: Annotated[float, typer.Option("--notch-depth", help="d of (8).")] = _PAPER.notch_depth,
    pole: Annotated[float, typer.Option("--pole", help="p of (4)(5), rad/s.")] = _PAPER.pole_rad_s,
    inertia: Annotated[
        float | None, typer.Option("--inertia", help="J_l/N² + J_m of (4)(5), kg m²; default: the model's.")
    ] = None,
    gear_ratio: Annotated[
        float | None, typer.Option("--gear-ratio", help="N of the observer; default: the model's.")
    ] = None,
    wheel_inertia: Annotated[
        float | None, typer.Option("--wheel-inertia", help="J_l of (9), wheels and dyno rotors, kg m².")
    ] = None,
    torque_limit: Annotated[
        float, typer.Option("--torque-limit", help="Largest motor torque, N m.")
    ] = _PAPER.torque_limit_nm,
    largest_sensitivity: Annotated[
        float, typer.Option("--largest-sensitivity", help="Limit of |S| for --optimize.")
    ] = _PAPER.limits.sensitivity_peak,
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
    spec = DesignSpec(
        stabilisation="phase" if notch_hz is None else "gain",
        pole_rad_s=pole,
        lead_deg=lead_deg,
        lead_hz=lead_hz,
        normalisation=_one_of("--normalisation", normalisation, get_args(Normalisation)),
        notch_hz=notch_hz,
        notch_width=notch_width,
        notch_depth=notch_depth,
        inertia_kg_m2=inertia,
        gear_ratio=gear_ratio,
        wheel_inertia_kg_m2=wheel_inertia,
        torque_limit_nm=torque_limit,
        optimise=optimize,
        objective=_one_of("--objective", objective, get_args(Objective)),
        limits=MarginLimits(sensitivity_peak=largest_sensitivity),
        name=name,
    )
    plant = load_model(model)
    beside = model.parent / "frf.csv"
    responses = frf or (beside if beside.is_file() else None)
    inputs = [model, *([responses] if responses else [])]
    with results_in(
        out, ("controller.toml", "design.json"), inputs=inputs, overwrite=overwrite, summary="design.json"
    ) as place:
        with progress("control design") as show:
            measured = frf_from_csv(responses) if responses else None
            found = design(plant, spec, progress=show)
            paper = None
            if optimize:
                wheel_inertia = found.controller.dfo.wheel_inertia_kg_m2
                # Only compared with: on another axle the paper's own lead may well be unstable.
                paper = design(plant, _as_in_the_paper(found.spec, wheel_inertia), unstable_too=True)
            show("figures")
            files = output_files(found, measured)
            summary = summary_of(found, paper, str(model), sorted(files))
            files["design.json"] = (to_json(summary) + "\n").encode()
        place.write(files, inputs)
    if json_:
        print_json(summary)
    else:
        print(text_of(found, paper, out))
    return 0


def _one_of(option: str, value: str, known: tuple[str, ...]) -> Any:
    if value not in known:
        raise BadInputError(f"{option} is '{value}'", fix=f"one of: {', '.join(known)}")
    return value


def _as_in_the_paper(spec: DesignSpec, wheel_inertia_kg_m2: float) -> DesignSpec:
    """The paper's lead and pole with everything else as given: what an optimum is compared with."""
    return replace(
        spec,
        pole_rad_s=_PAPER.pole_rad_s,
        lead_deg=_PAPER.lead_deg,
        lead_hz=_PAPER.lead_hz,
        normalisation=_PAPER.normalisation,
        wheel_inertia_kg_m2=wheel_inertia_kg_m2,
        optimise=False,
    )
