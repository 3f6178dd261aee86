"""A controller for a model: gains, filters, loops and what they keep."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from hil.analysis.control_design._acceptance import beyond_the_data, refuse_unstable, warnings_of
from hil.analysis.control_design._assembly import controller_of, refuse_resonance, speed_controls
from hil.analysis.control_design._laws import (
    DiscreteFilter,
    feed_forward,
    feedback_functions,
    observer_filter,
    pole_assignment,
    speed_filter,
    tustin,
)
from hil.analysis.control_design._loop import (
    feedback_response,
    hold_response,
    loop_grid,
    margins,
    sampled_response,
)
from hil.analysis.control_design._optimize import Optimum, optimize, trade_off
from hil.analysis.control_design._plant import design_plant, possible_plants
from hil.analysis.control_design._spec import Design, DesignSpec, Loop, Robustness
from hil.analysis.frequency_response import FrequencyResponse
from hil.analysis.plausible import within_floating_point
from hil.core.channels import OUTPUTS
from hil.core.controller import Controller
from hil.core.errors import BadInputError
from hil.core.model import Model, TransferFunction

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]


def design(
    model: Model,
    spec: DesignSpec,
    *,
    progress: Callable[[str], None] = lambda _: None,
    unstable_too: bool = False,
) -> Design:
    """Design the wheel speed control, its filters, and judge them.

    Args:
        model: the plant.
        spec: what is asked for.
        progress: called with what is being done.
        unstable_too: hand out an unstable loop as well, for comparisons; never load its controller.

    Raises:
        BadInputError: the model lacks an output, a resonance or an inertia; values out of range; the
            closed loop is unstable on the model; with `optimise`, no controller keeps the limits.
    """
    spec.check()
    with within_floating_point("this model"):
        return _designed(model, spec, progress, unstable_too)


def _designed(model: Model, spec: DesignSpec, progress: Callable[[str], None], unstable_too: bool) -> Design:
    plant = design_plant(model)
    motor = plant.functions[OUTPUTS[0]]
    refuse_resonance(spec, plant.resonance_hz, model.source)
    notes = list(plant.notes)
    inertia = spec.inertia_kg_m2 or plant.inertia_kg_m2
    origin_poles = 2 if motor.denominator[-1] == 0 else 1
    frequency = loop_grid(spec.sample_time_s)
    coarse = loop_grid(spec.sample_time_s, 700)
    plants = possible_plants(model, motor, coarse)
    # Aliasing is small: that of the model is that of its likely neighbours.
    held = plants.responses * (sampled_response(motor, coarse, spec.sample_time_s) / motor.response(coarse))
    optimum = _optimum(spec, coarse, held, inertia, origin_poles, progress)
    if optimum is not None:
        spec = _with_optimum(spec, optimum)
    progress("loops and margins")
    wscs = speed_controls(spec, pole_assignment(inertia, spec.pole_rad_s), plant.resonance_hz)
    wsc = wscs[spec.stabilisation]
    blocks = feedback_functions(wsc)
    response = motor.response(frequency)
    held_plant = sampled_response(motor, frequency, spec.sample_time_s)
    loops = [_loop("plant", (), frequency, response, held_plant, spec.sample_time_s, origin_poles - 1)]
    for name, one in wscs.items():
        parts = feedback_functions(one)
        loops.append(_loop(name, parts, frequency, response, held_plant, spec.sample_time_s, origin_poles))
    chosen = next(loop for loop in loops if loop.name == spec.stabilisation)
    if not unstable_too:
        refuse_unstable(motor, blocks, spec, chosen.margins)
    at, step, pi = plant.resonance_hz, spec.sample_time_s, loops[1].sampled
    chart = trade_off(frequency, pi, at, spec.normalisation, step, origin_poles=origin_poles)
    robust = _robustness(coarse, held, blocks, step, origin_poles, plants.source)
    warnings = (*_doubts(model), *warnings_of(chosen.margins, robust))
    notes += beyond_the_data(model, chosen.margins)
    controller = controller_of(model, spec, plant, wsc, notes, warnings)
    return Design(
        controller,
        plant,
        spec,
        frequency,
        tuple(loops),
        spec.stabilisation,
        chart,
        robust,
        plants,
        optimum,
        _discrete(controller),
        tuple(notes),
        warnings,
    )


def _doubts(model: Model) -> tuple[str, ...]:
    """What the model file itself says against its use."""
    return (f"the model is doubtful: {model.doubt}",) if model.doubt else ()


def _optimum(
    spec: DesignSpec,
    frequency: Array,
    held: ComplexArray,
    inertia: float,
    origin_poles: int,
    progress: Callable[[str], None],
) -> Optimum | None:
    if not spec.optimise:
        return None
    return optimize(
        frequency,
        held,
        inertia,
        spec.sample_time_s,
        limits=spec.limits,
        objective=spec.objective,
        origin_poles=origin_poles,
        progress=progress,
    )


def _with_optimum(spec: DesignSpec, optimum: Optimum) -> DesignSpec:
    return replace(
        spec,
        lead_deg=optimum.angle_deg,
        lead_hz=optimum.frequency_hz,
        pole_rad_s=optimum.pole_rad_s,
        normalisation=optimum.normalisation,
    )


def measured_loop(design: Design, frf: FrequencyResponse) -> dict[str, ComplexArray]:
    """The loops at the measured frequencies: measured motor speed response times controller and hold.

    Raises:
        BadInputError: the measurement has no motor speed.
    """
    if OUTPUTS[0] not in frf.outputs:
        raise BadInputError(f"the frequency response has no '{OUTPUTS[0]}'")
    step = design.spec.sample_time_s
    measured = frf.of(OUTPUTS[0]) * hold_response(frf.frequency_hz, step)
    gains = (design.controller.wsc.proportional_gain, design.controller.wsc.integral_gain)
    found = {"plant": measured}
    for name, wsc in speed_controls(design.spec, gains, design.plant.resonance_hz).items():
        found[name] = measured * feedback_response(feedback_functions(wsc), frf.frequency_hz, step)
    return found


def _loop(
    name: str,
    blocks: tuple[TransferFunction, ...],
    frequency: Array,
    response: ComplexArray,
    held_plant: ComplexArray,
    step: float,
    origin_poles: int,
) -> Loop:
    sampled = held_plant * feedback_response(blocks, frequency, step)
    continuous = response * feedback_response(blocks, frequency, None)
    return Loop(
        name,
        sampled,
        continuous,
        margins(frequency, sampled, origin_poles),
        margins(frequency, continuous, origin_poles),
    )


def _robustness(
    frequency: Array,
    plants: ComplexArray,
    blocks: tuple[TransferFunction, ...],
    step: float,
    origin_poles: int,
    source: str,
) -> Robustness:
    control = feedback_response(blocks, frequency, step)
    every = [margins(frequency, plant * control, origin_poles) for plant in plants]
    return Robustness(
        source,
        float(np.mean([m.stable for m in every])),
        max(m.sensitivity_peak for m in every),
        max(m.comfort_peak for m in every),
        min(m.gain_margin_db for m in every),
        min(m.phase_margin_deg for m in every),
        min(m.delay_margin_s for m in every),
    )


def _discrete(controller: Controller) -> dict[str, DiscreteFilter]:
    filters = controller.plant
    function = {
        "motor": TransferFunction(filters.motor_speed, filters.denominator),
        "wheel": TransferFunction(filters.wheel_speed, filters.denominator),
        "shaft": TransferFunction(filters.shaft_torque, filters.denominator),
    }
    blocks = {
        "speed_filter": speed_filter(
            function["motor"], function["wheel"], controller.wsc.filter_time_constant_s
        ),
        "feed_forward": feed_forward(function["shaft"], controller.dfc.feedforward_time_constant_s),
        "observer_filter": observer_filter(controller.dfo.time_constant_s),
    }
    names = ("pi", "lead" if controller.wsc.lead else "notch")
    blocks |= dict(zip(names, feedback_functions(controller.wsc), strict=True))
    return {name: tustin(block, controller.sample_time_s) for name, block in blocks.items()}
