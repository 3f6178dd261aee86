"""From a model to a controller, with margins and figures."""

from __future__ import annotations

from dataclasses import dataclass, replace

from hil.analysis.control_design import Design, DesignSpec, design
from hil.analysis.frequency_response import frf_from_csv
from hil.app.feedback import LOGGED, Feedback
from hil.app.requests import DesignRequest
from hil.app.result_file import Outcome, json_file
from hil.app.results_folder import results_in
from hil.core.model import load_model
from reports import HTML, PDF
from reports.design_report import design_page
from reports.origin import origin_of
from reports.outputs.control_design import output_files, summary_of
from reports.parts import documents

SUMMARY = "design.json"
_NAMES = ("controller.toml", SUMMARY, HTML, PDF)
_PAPER = DesignSpec()


@dataclass(frozen=True)
class Designed:
    """The design, and beside an optimum the paper's lead and pole on the same model."""

    design: Design
    paper: Design | None


def design_controller(request: DesignRequest, feedback: Feedback = LOGGED) -> Outcome[Designed]:
    """Design, and write controller, figures and report.

    Raises:
        BadInputError: the model has no plant for it, or no stable loop results.
    """
    spec = request.spec or _PAPER
    plant = load_model(request.model)
    beside = request.model.parent / "frf.csv"
    responses = request.frf or (beside if beside.is_file() else None)
    inputs = [request.model, *([responses] if responses else [])]
    with results_in(
        request.out, _NAMES, inputs=inputs, overwrite=request.overwrite, default="design", summary=SUMMARY
    ) as place:
        with feedback.progress("control design") as show:
            measured = frf_from_csv(responses) if responses else None
            found = design(plant, spec, progress=show)
            paper = None
            if spec.optimise:
                wheel_inertia = found.controller.dfo.wheel_inertia_kg_m2
                # Only compared with: on another axle the paper's own lead may well be unstable.
                paper = design(plant, _as_in_the_paper(found.spec, wheel_inertia), unstable_too=True)
            show("figures")
            files = output_files(found, measured)
            summary = summary_of(found, paper, str(request.model), sorted([*files, HTML, PDF]))
            used = {"model": [request.model], "measured response": [responses] if responses else []}
            files |= documents(design_page(found, summary, files, request.model.name, origin_of(used)))
            files[SUMMARY] = json_file(summary)
        place.write(files, inputs)
    return Outcome(Designed(found, paper), summary, place.folder)


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
