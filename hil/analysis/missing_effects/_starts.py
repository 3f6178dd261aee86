"""Numbers to start from, by the data alone: the same from any base of the same kind."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from hil.analysis.missing_effects._hypothesis import Hypothesis
from hil.analysis.missing_effects._series import Series
from hil.core.model import Model

Array = npt.NDArray[np.float64]


def starts_of(model: Model, series: Sequence[Series]) -> list[Hypothesis]:
    """The base as it came, and with inertia and drag that the recordings as a whole ask for."""
    base = Hypothesis(model, dict(model.parameters))
    whole = _inertia_and_drag(model, series)
    if whole is None:
        return [base]
    inertia, drag = whole
    numbers = dict(model.parameters)
    share = inertia / (numbers["motor_inertia"] + numbers["vehicle_inertia"] / numbers["gear_ratio"] ** 2)
    for name in ("motor_inertia", "wheel_inertia", "vehicle_inertia"):
        if name in numbers:
            numbers[name] *= share
    if "viscous_drag" in numbers:
        numbers["viscous_drag"] = drag
    return [base, Hypothesis(model, numbers)]


def _inertia_and_drag(model: Model, series: Sequence[Series]) -> tuple[float, float] | None:
    """Whole inertia (kg m², rotor side) and drag (N m s/rad) of a turning mass with dry friction and an offset.

    Momentum over impulse, J·(ω - ω₀) = ∫T - b·∫ω - c·∫sgn ω - o·t, as a linear regression: nothing is differentiated.
    None where no speed was recorded, or a mass that is not positive comes out.
    """
    columns, right = [], []
    ratio = model.parameters["gear_ratio"]
    for index, one in enumerate(series):
        if not one.has[:2].any():
            continue
        speed = one.samples[:, 0] if one.has[0] else one.samples[:, 1] * ratio
        load = np.zeros_like(speed) if one.load is None else one.load / ratio
        quiet = np.abs(speed) > 1e-3 * np.max(np.abs(speed))
        causes = [one.torque - load, -speed, -np.sign(speed) * quiet, -np.ones_like(speed)]
        impulses = [np.cumsum(cause) * one.dt for cause in causes]
        begins = np.zeros((len(speed), len(series)))
        begins[:, index] = 1.0
        columns.append(np.column_stack([*impulses, begins])[:: one.block])
        right.append(speed[:: one.block])
    if not columns:
        return None
    found = np.linalg.lstsq(np.concatenate(columns), np.concatenate(right), rcond=1e-9)[0]
    if found[0] <= 0.0:
        return None
    return float(1.0 / found[0]), float(max(found[1] / found[0], 0.0))
