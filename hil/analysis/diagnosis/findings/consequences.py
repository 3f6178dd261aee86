"""What the new model changes in what the bench is judged by: overshoot of a torque step, band energy."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.findings.apart import played
from hil.analysis.diagnosis.findings.thresholds import LASTING, STEP_FROM_RAD_S, STEP_NM
from hil.core.channels import COMFORT_BAND_HZ, OUTPUTS, TICK_S
from hil.core.model import Model
from test_plans.metrics import energy_within, periodogram

Array = npt.NDArray[np.float64]

_MOTOR, _, _SHAFT = OUTPUTS


def consequences(before: Model, after: Model, as_likely: Sequence[Model] = ()) -> dict[str, dict[str, float]]:
    """Peak shaft torque over its steady value (%), and 8-20 Hz energy of the motor speed ((rad/s)²).

    An open-loop step of `STEP_NM` from `STEP_FROM_RAD_S` wheel speed, the model before and after. The energy
    is the mean square within the band of what rings in the 5 s from the step on. It is not that of an
    acceptance run, in which a controller acts and which looks from 4 s after the step on, when nothing of
    this rings. Nothing where `why_no_step` has a reason; no overshoot where little of the peak lasts: drag
    holds the motor then, the shaft passes nothing on.

    Args:
        as_likely: models that the data allow as well as `after`: their scatter is its standard error.
    """
    if why_no_step(after):
        return {}
    shown = [before, after, *(as_likely if len(as_likely) > 1 else ())]
    old, new, *drawn = [_figures(outputs) for outputs in _stepped(shown)]
    result = {name: {"before": old[name], "after": new[name]} for name in new if name in old}
    for name, value in result.items():
        scatter = [one[name] for one in drawn if name in one]
        if len(scatter) > 1:
            value["after_standard_error"] = float(np.std(scatter, ddof=1))
    return result


def why_no_step(model: Model) -> str:
    """Why no torque step of a model is judged, in a sentence; "" where it is."""
    functions = model.transfer_functions
    if model.load_input:
        return "The model takes its load from recordings: what its wheels meet in a step is not in it."
    if model.kind == "rigid":
        return "The model's axle is rigid: it neither overshoots nor rings."
    if functions and (missing := [name for name in (_MOTOR, _SHAFT) if name not in functions]):
        return (
            f"The model has no transfer function of {' and '.join(missing)}: a step of it cannot be judged."
        )
    return ""


def _stepped(models: Sequence[Model]) -> Array:
    """Outputs of models in the step, models x samples x 3."""
    torque = np.concatenate([np.zeros(1000), np.full(5000, STEP_NM)])
    return played(models, torque, TICK_S, STEP_FROM_RAD_S)


def _figures(outputs: Array) -> dict[str, float]:
    """Of one model's outputs, samples x 3."""
    motor, _, shaft = outputs.T
    resting = float(np.mean(shaft[500:1000]))
    steady, peak = float(np.mean(shaft[-2000:])) - resting, float(np.max(shaft[1000:])) - resting
    figures = {"band_energy_motor_speed": _ringing(motor[1000:])}
    if steady > LASTING * peak:
        figures = {"overshoot_shaft_torque_percent": 100.0 * (peak / steady - 1.0)} | figures
    return figures


def _ringing(values: Array) -> float:
    """Mean square within the comfort band.

    No window: it would be zero where a step rings most, and show when the step comes, not how it rings.
    """
    return energy_within(*periodogram(values, TICK_S, tapered=False), *COMFORT_BAND_HZ)
