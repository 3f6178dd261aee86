"""`hil design`: from a model to a controller, with margins and figures."""

from __future__ import annotations

from typing import Any, get_args

from hil.analysis.control_design import DesignSpec, MarginLimits, Normalisation, Objective
from hil.app.design import design_controller
from hil.app.requests import DesignRequest
from hil.cli.inputs import request_of
from hil.cli.options.controllers import Design
from hil.cli.output import TERMINAL, print_json
from hil.core.errors import BadInputError
from reports.outputs.control_design import text_of


def execute(options: Design) -> int:
    """Execute the command; its exit code."""
    outcome = design_controller(request_of(DesignRequest, options, spec=_spec(options)), TERMINAL)
    if options.json_:
        print_json(outcome.summary)
    else:
        print(text_of(outcome.found.design, outcome.found.paper, outcome.folder))
    return 0


def _spec(options: Design) -> DesignSpec:
    return DesignSpec(
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
        wheel_inertia_kg_m2=options.wheel_inertia,
        torque_limit_nm=options.torque_limit,
        half_gap_rad=options.half_gap,
        optimise=options.optimize,
        objective=_one_of("--objective", options.objective, get_args(Objective)),
        limits=MarginLimits(sensitivity_peak=options.largest_sensitivity),
        name=options.name,
    )


def _one_of(option: str, value: str, known: tuple[str, ...]) -> Any:
    if value not in known:
        raise BadInputError(f"{option} is '{value}'", fix=f"one of: {', '.join(known)}")
    return value
