"""A draft of a controller on cars that are drawn around its model."""

from __future__ import annotations

import functools
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from pydantic import ValidationError

from hil.analysis.control_design import (
    COMFORT_BAND_HZ,
    Margins,
    feedback_functions,
    feedback_response,
    loop_grid,
    margins,
    possible_plants,
    sampled_response,
)
from hil.analysis.identification import stated_errors
from hil.analysis.tuning import Draw, SpeedLoops, Tolerance, draws_of, read_free
from hil.core.channels import OUTPUTS
from hil.core.controller import Controller
from hil.core.errors import BadInputError, HilError
from hil.core.errors.mistakes import mistakes_of
from hil.core.model import Model, load_model
from hil.fmu.axle import Axle
from hil.service.worker_pool._designing import SPEEDS_KM_H, STEP_NM, drafts_of, margin_fields, spec_of
from hil.service.worker_pool.drawn_numbers import number, numbers
from test_plans.metrics import energy_within, periodogram

_KEPT = 4
_SHOWN_HZ = (0.3, 60.0)
_EACH = 3  # of the frequencies that are drawn
_REST, _AFTER = 100, 1000  # milliseconds
_STEP_S = 0.001

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]


@dataclass(frozen=True)
class Cars:
    """The model itself and cars drawn around it, with what a speed loop closes around.

    Attributes:
        draws: of a chain; none of a model that has no inertias to be drawn.
        plants: D x F sampled motor speed responses.
        origin_poles: of the open loop, by car.
        source: where they come from, for people.
    """

    draws: tuple[Draw, ...]
    frequency_hz: Array
    plants: ComplexArray
    origin_poles: tuple[int, ...]
    source: str

    def open_loops(self, controller: Controller) -> ComplexArray:
        """D x F."""
        blocks = feedback_functions(controller.wsc)
        return np.asarray(self.plants * feedback_response(blocks, self.frequency_hz, _STEP_S))

    def margins(self, loops: ComplexArray) -> list[Margins]:
        """Of each car's open loop."""
        cars = zip(loops, self.origin_poles, strict=True)
        return [margins(self.frequency_hz, loop, poles) for loop, poles in cars]


def cloud(
    model: str, cars: int, tolerance: dict[str, float] | None, seed: int, **chosen: Any
) -> dict[str, Any]:
    """Fields of `CloudData` for a model file.

    Raises:
        BadInputError: the model cannot be designed for, or a value or a tolerance is out of range.
    """
    controller = drafts_of(model).draft(spec_of(chosen)).controller
    drawn = cars_of(model, cars, json.dumps(tolerance), seed)
    loops = drawn.open_loops(controller)
    found = drawn.margins(loops)
    shown = (drawn.frequency_hz >= _SHOWN_HZ[0]) & (drawn.frequency_hz <= _SHOWN_HZ[1])
    seen = loops[:, shown][:, ::_EACH]
    sensitivity = 1 / np.maximum(np.abs(1 + seen), 1e-9)
    worst = worst_of(found)
    figures, why_not = _figures(drawn, controller)
    return {
        "source": drawn.source,
        "frequency_hz": numbers(drawn.frequency_hz[shown][::_EACH]),
        "loops": [{"real": numbers(one.real), "imaginary": numbers(one.imag)} for one in seen],
        "sensitivity_lower": numbers(sensitivity.min(axis=0)),
        "sensitivity_upper": numbers(sensitivity.max(axis=0)),
        "worst": worst,
        "worst_sensitivity": numbers(sensitivity[worst]),
        "cars": [
            {"margins": margin_fields(one), **figure, "differs": dict(differs)}
            for one, figure, differs in zip(found, figures, _differences(drawn), strict=True)
        ],
        "steps_why_not": why_not,
    }


def worst_of(found: list[Margins]) -> int:
    """Place of the one that is unstable, or has the largest |S|."""
    return max(range(len(found)), key=lambda at: (not found[at].stable, found[at].sensitivity_peak))


@functools.lru_cache(_KEPT)
def cars_of(model: str, count: int, tolerance: str, seed: int) -> Cars:
    """Cars around a model file; `tolerance` is JSON of `CloudWanted.tolerance`.

    Raises:
        BadInputError: a tolerance that is out of range or of a parameter that the model lacks.
    """
    axle = load_model(Path(model))
    wanted: dict[str, float] | None = json.loads(tolerance)
    if axle.kind == "transfer_function":
        return _of_functions(model, axle, count, seed, wanted)
    spread = tolerance_of(axle, wanted)
    draws = draws_of(axle, spread, count, seed)
    loops = SpeedLoops([one.model for one in draws], _STEP_S)
    source = _source(axle, spread, len(draws) - 1)
    return Cars(draws, loops.frequency_hz, loops.plants, loops.origin_poles, source)


def _of_functions(path: str, model: Model, count: int, seed: int, wanted: dict[str, float] | None) -> Cars:
    """A model of transfer functions has a covariance, or assumed tolerances, in place of parameters."""
    if wanted:
        what = "a model of transfer functions has no parameters that could have a tolerance"
        raise BadInputError(what, where="tolerance", fix="leave it out, or choose a chain")
    drafts = drafts_of(path)
    motor = drafts.plant.functions[OUTPUTS[0]]
    grid = loop_grid(_STEP_S, 900)
    drawn = possible_plants(model, motor, grid, draws=count, seed=seed)
    # Aliasing is small: that of the model is that of its likely neighbours.
    held = drawn.responses * (sampled_response(motor, grid, _STEP_S) / motor.response(grid))
    poles = 2 if motor.denominator[-1] == 0 else 1
    return Cars((), grid, held, (poles,) * len(held), drawn.source)


def tolerance_of(model: Model, wanted: dict[str, float] | None) -> Tolerance:
    """As asked for; else of the model's file; else what `hil tune` takes, where the model has it.

    Raises:
        BadInputError: a value out of range, or no such parameter.
    """
    if wanted is not None:
        try:
            return Tolerance.model_validate(Tolerance.apart(dict(wanted)))
        except ValidationError as error:
            raise BadInputError("; ".join(mistakes_of(error, Tolerance)), where="tolerance") from error
    if model.tolerance:
        known = {name: share for name, share in model.tolerance.items() if name in model.parameters}
        return Tolerance(relative=known)
    shipped = read_free(None).tolerance
    known = {name: share for name, share in shipped.relative.items() if name in model.parameters}
    late_s = shipped.dead_time_s if "torque_delay" in model.parameters else 0.0
    return Tolerance(relative=known, dead_time_s=late_s)


def _source(model: Model, spread: Tolerance, count: int) -> str:
    parts = [f"{name} ±{share:.3g}" for name, share in spread.relative.items() if share > 0]
    if spread.dead_time_s:
        parts.append(f"dead time ±{1000 * spread.dead_time_s:g} ms")
    if stated_errors(model):
        parts.append("standard errors of the model's numbers")
    return f"{count} cars: {', '.join(parts)}" if parts and count else "the model alone: nothing differs"


def _differences(cars: Cars) -> list[dict[str, float]]:
    if not cars.draws:
        return [{} for _ in cars.plants]
    return [dict(one.differs) for one in cars.draws]


def _figures(cars: Cars, controller: Controller) -> tuple[list[dict[str, Any]], str]:
    """Overshoots and band energy of each car's steps, and why there are none."""
    none = {"overshoot_nm": [None] * len(SPEEDS_KM_H), "band_energy": None}
    if not cars.draws:
        return [none] * len(cars.plants), "cars of a model of transfer functions have no inertias to simulate"
    found, why_not = [], ""
    for draw in cars.draws:
        try:
            found.append(_steps(draw.model, controller))
        except HilError as error:  # the loops can be looked at all the same
            found.append(none)
            why_not = error.what
    return found, why_not


def _steps(model: Model, controller: Controller) -> dict[str, Any]:
    overshoots, energy = [], 0.0
    for speed_km_h in SPEEDS_KM_H:
        axle = Axle(model, controller, model.wheel_radius_m, speed_km_h / 3.6)
        given = axle.play(np.r_[np.zeros(_REST), np.full(_AFTER, STEP_NM)])
        overshoots.append(number(max(0.0, float(np.max(given["shaft_torque_nm"])) - STEP_NM)))
        energy = band_energy(given["motor_speed_rad_s"])
    return {"overshoot_nm": overshoots, "band_energy": number(energy)}


def band_energy(motor_speed: Array) -> float:
    """Mean square from 8 to 20 Hz, as `band_energy` has it, over as long before the step as after it.

    Its Hann window is then largest where the step rings. What lies before the recording is at rest.

    Args:
        motor_speed: from `_REST` milliseconds before the step, rad/s.
    """
    before = np.full(_AFTER - _REST, motor_speed[0])
    frequency, density = periodogram(np.r_[before, motor_speed], _STEP_S)
    return energy_within(frequency, density, *COMFORT_BAND_HZ)
