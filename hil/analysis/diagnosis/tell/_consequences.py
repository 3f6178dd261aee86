"""What the new model changes in what the bench is judged by: overshoot of a torque step, band energy."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.tell._thresholds import STEP_NM
from hil.core.channels import OUTPUTS
from hil.core.conventions import COMFORT_BAND_HZ, TICK_S
from hil.core.model import Model
from hil.plant import Start, gear_ratio_of, simulate
from test_plans.metrics import energy_within, periodogram

Array = npt.NDArray[np.float64]

_MOTOR, _, _SHAFT = OUTPUTS


def consequences(before: Model, after: Model, as_likely: Sequence[Model] = ()) -> dict[str, dict[str, float]]:
    """Peak shaft torque over its steady value (%), and 8-20 Hz energy of the motor speed ((rad/s)²).

    An open-loop step of 20 N m from 5 rad/s wheel speed, with the model before and after. Nothing for a
    model whose load comes from a recording (what its wheels would meet in a step is not in it), and for
    functions that do not give both.

    Args:
        as_likely: models that the data allow as well as `after`: their scatter is its standard error.
    """
    functions = after.transfer_functions
    if after.load_input or (functions and not {_MOTOR, _SHAFT} <= {*functions}):
        return {}
    figures = {"before": _figures(before), "after": _figures(after)}
    result = {name: {when: one[name] for when, one in figures.items()} for name in figures["after"]}
    drawn = [_figures(model) for model in as_likely]
    if len(drawn) > 1:
        for name, value in result.items():
            value["after_standard_error"] = float(np.std([one[name] for one in drawn], ddof=1))
    return result


def _figures(model: Model) -> dict[str, float]:
    """Of one model."""
    torque = np.concatenate([np.zeros(1000), np.full(5000, STEP_NM)])
    start = Start(5.0 * (gear_ratio_of(model) or 1.0), 5.0, 0.0)
    channels = simulate(model, torque, TICK_S, start)
    shaft, motor = channels[_SHAFT], channels[_MOTOR]
    resting = float(np.mean(shaft[500:1000]))
    steady, peak = float(np.mean(shaft[-2000:])) - resting, float(np.max(shaft[1000:])) - resting
    return {
        "overshoot_shaft_torque_percent": 100.0 * max(0.0, peak / steady - 1.0) if steady else 0.0,
        "band_energy_motor_speed": _band_energy(motor[1000:]),
    }


def _band_energy(values: Array) -> float:
    return energy_within(*periodogram(values, TICK_S), *COMFORT_BAND_HZ)
