"""Cars that the bench may bring: the model with numbers drawn from its uncertainty and from tolerances."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from hil.analysis.identification import stated_errors
from hil.analysis.tuning._free import Tolerance
from hil.core.errors import BadInputError
from hil.core.model import EffectUse, Model

Array = npt.NDArray[np.float64]

_ORDERS = ("wheel_order_disturbance", "motor_order_ripple")
_GAP = "backlash"
_SHARE = 0.999  # of a normal distribution is drawn from: no draw lies beyond 3.3 standard errors
_SMALLEST_GAP_RAD = 1e-6


@dataclass(frozen=True)
class Draw:
    """One car: its model, the noise of its sensors (times the bench's), and what differs, for people."""

    number: int
    model: Model
    noise: float = 0.0
    seed: int = 0
    differs: Mapping[str, float] = field(default_factory=dict)


def draws_of(model: Model, tolerance: Tolerance, count: int, seed: int) -> tuple[Draw, ...]:
    """The model itself, without noise, and `count` draws, a scrambled Sobol sequence over what may differ.

    Tolerances are half widths of an even distribution; standard errors under the model's `meta` are of a
    normal one.

    Raises:
        BadInputError: a tolerance of a parameter that the model has not.
    """
    dimensions = _dimensions(model, tolerance)
    found = [Draw(0, model)]
    if count and not dimensions and not tolerance.sensor_noise:
        return tuple(found)
    from scipy.stats import qmc

    errors = stated_errors(model)
    sobol = qmc.Sobol(max(1, len(dimensions)), seed=np.random.default_rng(seed))
    points = sobol.random_base2(max(0, math.ceil(math.log2(max(count, 1)))))[:count]
    for number, point in enumerate(points, 1):
        chosen = dict(zip(dimensions, point.tolist(), strict=False))
        found.append(_drawn(model, tolerance, errors, chosen, number, seed))
    return tuple(found)


def differing(model: Model, tolerance: Tolerance) -> bool:
    """Whether cars that are drawn around a model differ from it.

    Raises:
        BadInputError: a tolerance of a parameter that the model has not.
    """
    return bool(_dimensions(model, tolerance)) or tolerance.sensor_noise > 0


def _dimensions(model: Model, tolerance: Tolerance) -> list[str]:
    """What is drawn of a car.

    Raises:
        BadInputError: a tolerance of a parameter that the model has not.
    """
    for name in tolerance.relative:
        if name not in model.parameters:
            raise BadInputError(
                f"tolerance.{name}: a '{model.kind}' model has no such parameter", fix="leave it out"
            )
    return [
        *(f"even {name}" for name, share in tolerance.relative.items() if share > 0),
        *(f"normal {name}" for name in stated_errors(model)),
        *(["dead_time_s"] if tolerance.dead_time_s > 0 else []),
        *(["backlash_rad"] if tolerance.backlash_rad > 0 else []),
        *(f"phase {n}" for n, use in enumerate(model.effects) if tolerance.order_phase and use.id in _ORDERS),
    ]


def _drawn(
    model: Model,
    tolerance: Tolerance,
    errors: Mapping[str, float],
    chosen: Mapping[str, float],
    number: int,
    seed: int,
) -> Draw:
    from scipy.special import ndtri

    parameters = dict(model.parameters)
    for name, error in errors.items():
        share = 0.5 + _SHARE * (chosen[f"normal {name}"] - 0.5)
        moved = parameters[name] + error * float(ndtri(share))
        parameters[name] = max(moved, 0.05 * parameters[name])  # an error bar may be wider than its number
    for name, width in tolerance.relative.items():
        if width > 0:
            parameters[name] *= 1 + width * (2 * chosen[f"even {name}"] - 1)
    if tolerance.dead_time_s:
        late = tolerance.dead_time_s * (2 * chosen["dead_time_s"] - 1)
        parameters["torque_delay"] = max(0.0, parameters["torque_delay"] + late)
    effects, angles = [], {}
    for place, use in enumerate(model.effects):
        key = f"phase {place}"
        if key in chosen:
            angles[f"{use.id}.phase_rad"] = 2 * math.pi * chosen[key]
            use = EffectUse(use.id, {**use.values, "phase_rad": angles[f"{use.id}.phase_rad"]})
        effects.append(use)
    if tolerance.backlash_rad:
        gap = max(_SMALLEST_GAP_RAD, tolerance.backlash_rad * chosen["backlash_rad"])
        angles["backlash.half_gap_rad"] = gap
        effects = [use for use in effects if use.id != _GAP] + [_with_gap(model, gap)]
    differs = {n: v for n, v in parameters.items() if v != model.parameters[n]} | angles
    drawn = model.with_parameters(**parameters).with_effects(*effects)
    return Draw(number, drawn, tolerance.sensor_noise, seed + number, differs)


def _with_gap(model: Model, gap_rad: float) -> EffectUse:
    """The model's own gap with another width, or a new one."""
    own = next((use.values for use in model.effects if use.id == _GAP), {})
    return EffectUse(_GAP, {**own, "half_gap_rad": gap_rad})
