"""`hil design`: from a model to a controller, with margins and figures."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, get_args

from hil.analysis.control_design import DesignSpec, MarginLimits, Normalisation, Objective, design
from hil.analysis.frequency_response import frf_from_csv
from hil.cli._output import print_json, progress, to_json
from hil.cli._results_folder import results_in
from hil.cli.commands.design import Design
from hil.core.errors import BadInputError
from hil.core.model import load_model
from reports import HTML, PDF
from reports.design_report import design_page
from reports.origin import origin_of
from reports.outputs.control_design import output_files, summary_of, text_of
from reports.parts import documents

_PAPER = DesignSpec()


def carry_out(options: Design) -> int:
    """Carry the command out; its exit code."""
    wheel_inertia = options.wheel_inertia
    spec = DesignSpec(
        stabilisation="phase" if options.notch_hz is None else "gain",
        pole_rad_s=options.pole,
        lead_deg=options.lead_deg,
        lead_hz=options.lead_hz,
        normalisation=_one_of("--normalisation", options.normalisation, get_args(Normalisation)),
        notch_hz=options.notch_hz,
        notch_width=options.notch_width,
        notch_depth=options.notch_depth,
        inertia_kg_m2=options.inertia,
        gear_ratio=options.gear_ratio,
        wheel_inertia_kg_m2=wheel_inertia,
        torque_limit_nm=options.torque_limit,
        optimise=options.optimize,
        objective=_one_of("--objective", options.objective, get_args(Objective)),
        limits=MarginLimits(sensitivity_peak=options.largest_sensitivity),
        name=options.name,
    )
    plant = load_model(options.model)
    beside = options.model.parent / "frf.csv"
    responses = options.frf or (beside if beside.is_file() else None)
    inputs = [options.model, *([responses] if responses else [])]
    with results_in(
        options.out,
        ("controller.toml", "design.json", HTML, PDF),
        inputs=inputs,
        overwrite=options.overwrite,
        default="design",
        summary="design.json",
    ) as place:
        with progress("control design") as show:
            measured = frf_from_csv(responses) if responses else None
            found = design(plant, spec, progress=show)
            paper = None
            if options.optimize:
                wheel_inertia = found.controller.dfo.wheel_inertia_kg_m2
                # Only compared with: on another axle the paper's own lead may well be unstable.
                paper = design(plant, _as_in_the_paper(found.spec, wheel_inertia), unstable_too=True)
            show("figures")
            files = output_files(found, measured)
            summary = summary_of(found, paper, str(options.model), sorted([*files, HTML, PDF]))
            used = {"model": [options.model], "measured response": [responses] if responses else []}
            files |= documents(design_page(found, summary, files, options.model.name, origin_of(used)))
            files["design.json"] = (to_json(summary) + "\n").encode()
        place.write(files, inputs)
    if options.json_:
        print_json(summary)
    else:
        print(text_of(found, paper, place.folder))
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
