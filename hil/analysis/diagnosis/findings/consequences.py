"""Two models in one simulated test: how far apart they are, and what a new one changes of what is judged.

Two models that were fitted to the same recordings differ a little in every number, and so in every test. A
test tells them apart by what is left of the difference once the numbers have been fitted anew.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.thresholds import LASTING, NUMBERS_FREE, STEP_FROM_RAD_S, STEP_NM
from hil.core.channels import COMFORT_BAND_HZ, OUTPUTS, TICK_S
from hil.core.model import Model, parameter_names
from hil.plant import SENSOR_STEP, gear_ratio_of, pack, sensor_of, simulate_many
from test_plans.metrics import energy_within, periodogram

Array = npt.NDArray[np.float64]

_MOTOR, _, _SHAFT = OUTPUTS


def played(models: Sequence[Model], torque: Array, step: float, wheel_speed: float) -> Array:
    """Outputs in the order of `OUTPUTS`, models x samples x 3; 0 for one that a model does not have.

    Args:
        models: with the same transfer functions, if with any.
        torque: shape (n,), N m, held for `step` seconds each; none has acted before.
        wheel_speed: at the start, in rad/s, no torque in the shafts.
    """
    slots, sensors = np.stack([pack(model) for model in models]), np.stack([_sensors_of(m) for m in models])
    starts = [(wheel_speed * (gear_ratio_of(model) or 1.0), wheel_speed, 0.0) for model in models]
    from_rest = np.concatenate([[0.0], torque])
    functions = models[0].transfer_functions
    return simulate_many(slots, from_rest, step, np.array(starts), sensors, functions=functions)[:, 1:]


def apart(one: Model, other: Model, played: Callable[[Sequence[Model]], Array], noise: Array) -> Array:
    """What `one`, its numbers fitted anew, leaves of what `other` shows: (samples, channels), noise levels.

    Args:
        played: outputs of models in the test, models x samples x channels.
        noise: standard deviation of each channel per sample.
    """
    first, second, *moved = played([one, other, *_moved(one)]) / noise
    columns = [np.ravel((shown - first) / NUMBERS_FREE) for shown in moved]
    starts = np.eye(first.shape[1])  # an initial speed that no one knows shifts a channel
    columns += [np.ravel(np.broadcast_to(channel, first.shape)) for channel in starts]
    rows = np.nan_to_num(np.column_stack(columns))
    free = np.array([NUMBERS_FREE] * (len(columns) - len(starts)) + [np.inf] * len(starts))
    difference = np.ravel(np.nan_to_num(first - second))
    size = np.linalg.norm(rows, axis=0)
    kept = size > 0.0
    scaled = rows[:, kept] / size[kept]
    anchor = np.diag(1.0 / (free[kept] * size[kept]))
    system = np.vstack([scaled, anchor])
    right = np.concatenate([difference, np.zeros(len(anchor))])
    made_up = scaled @ np.linalg.lstsq(system, right, rcond=None)[0]
    return np.asarray((difference - made_up).reshape(first.shape))


def _moved(one: Model) -> Iterator[Model]:
    """The model with one number a little larger: of its base, of its effects."""
    for name in parameter_names(one.kind):
        if value := one.parameters[name]:
            yield one.with_parameters(**{name: value * (1.0 + NUMBERS_FREE)})
    for index, use in enumerate(one.effects):
        for name, number in use.values.items():
            if not isinstance(number, str) and number:
                larger = replace(use, values={**use.values, name: number * (1.0 + NUMBERS_FREE)})
                yield one.with_effects(*(larger if i == index else u for i, u in enumerate(one.effects)))


def _sensors_of(model: Model) -> Array:
    """The numbers of each channel's sensor, not its rounding."""
    sensors = np.stack([sensor_of(model, channel) for channel in OUTPUTS])
    sensors[:, SENSOR_STEP] = 0.0
    return sensors


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
