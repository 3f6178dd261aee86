"""A fit as a table inside a model file, so that its uncertainty travels with it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from hil.analysis.identification._modal import Modes, Structure
from hil.analysis.identification._rational_fit import Fit
from hil.core.effects import finite_number
from hil.core.errors import BadInputError
from hil.core.model import Model, TransferFunction


def model_of(fit: Fit, meta: Mapping[str, Any]) -> Model:
    """A `transfer_function` model with common denominator and dead time; the fit goes under `meta.fit`."""
    numerators, denominator = fit.polynomials()
    poles = tuple(float(c) for c in denominator)
    functions = {}
    for name, numerator, two in zip(fit.outputs, numerators, fit.modes.structure.roll_off, strict=True):
        start = 1 if two == 2 else 0
        functions[name] = TransferFunction(
            tuple(float(c) for c in numerator[start:]), poles, fit.modes.delay_s
        )
    return Model("transfer_function", transfer_functions=functions, meta=dict(meta) | {"fit": _table(fit)})


def stated_errors(model: Model) -> dict[str, float]:
    """Standard errors of a chain's parameters, in their units, as far as its file states them."""
    stated = model.meta.get("standard_errors")
    if not isinstance(stated, dict):
        return {}
    numbers = {name: finite_number(stated[name]) for name in model.parameters if name in stated}
    return {name: value for name, value in numbers.items() if value is not None and value > 0}


def fit_of(model: Model) -> Fit | None:
    """The fit stored by `model_of`; None when the model was not identified.

    Raises:
        BadInputError: the table was damaged.
    """
    table = model.meta.get("fit")
    if table is None:
        return None
    try:
        structure = Structure(
            bool(table["integrator"]),
            int(table["sections"]),
            bool(table["real_pole"]),
            tuple(bool(v) for v in table["integrating"]),
            tuple(int(v) for v in table["roll_off"]),
        )
        modes = Modes(
            structure,
            np.array(table["poles"], float),
            np.array(table["coefficients"], float),
            float(table["delay_s"]),
        )
        if structure.sections < 0 or modes.poles.shape != (structure.pole_parameters,):
            raise ValueError("wrong number of poles")
        covariance = np.array(table["covariance"], float)
        outputs = tuple(str(name) for name in table["outputs"])
        size = structure.pole_parameters + 1
        size += sum(structure.free_coefficients(o).shape[1] for o in range(len(outputs)))
        if covariance.shape != (size, size) or modes.coefficients.shape != (len(outputs), structure.order):
            raise ValueError("sizes do not go together")
        if len(structure.integrating) != len(outputs) or len(structure.roll_off) != len(outputs):
            raise ValueError("sizes do not go together")
        numbers = (modes.poles, modes.coefficients, covariance, np.array([modes.delay_s]))
        if (
            not all(np.all(np.isfinite(part)) for part in numbers)
            or not 0 <= modes.delay_s <= 1
            or not np.all(modes.poles > 0)
        ):
            raise ValueError("it holds numbers that cannot be")
        chi_square = float(table["chi_square"])
    except (KeyError, TypeError, ValueError, IndexError, OverflowError) as error:
        raise BadInputError(f"[meta.fit] cannot be read: {error}", fix="identify again") from error
    return Fit(modes, outputs, covariance, chi_square, np.zeros((len(outputs), 0), complex))


def _table(fit: Fit) -> dict[str, Any]:
    modes, structure = fit.modes, fit.modes.structure
    return {
        "outputs": list(fit.outputs),
        "integrator": structure.integrator,
        "sections": structure.sections,
        "real_pole": structure.real_pole,
        "integrating": list(structure.integrating),
        "roll_off": list(structure.roll_off),
        "poles": modes.poles.tolist(),
        "coefficients": modes.coefficients.tolist(),
        "delay_s": modes.delay_s,
        "chi_square": fit.chi_square,
        "covariance": fit.covariance.tolist(),
    }
