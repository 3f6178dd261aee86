"""How far two models differ in a test beyond what their numbers and initial speeds could make up for.

Two models that were fitted to the same recordings differ a little in every number, and so in every test. A
test tells them apart by what is left of the difference once the numbers have been fitted anew.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.findings.thresholds import NUMBERS_FREE, NUMBERS_STEP
from hil.core.channels import OUTPUTS
from hil.core.model import Model, parameter_names
from hil.plant import SENSOR_STEP, gear_ratio_of, pack, sensor_of, simulate_many

Array = npt.NDArray[np.float64]


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
    columns = [np.ravel((shown - first) / NUMBERS_STEP) for shown in moved]
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
            yield one.with_parameters(**{name: value * (1.0 + NUMBERS_STEP)})
    for index, use in enumerate(one.effects):
        for name, number in use.values.items():
            if not isinstance(number, str) and number:
                larger = replace(use, values={**use.values, name: number * (1.0 + NUMBERS_STEP)})
                yield one.with_effects(*(larger if i == index else u for i, u in enumerate(one.effects)))


def _sensors_of(model: Model) -> Array:
    """The numbers of each channel's sensor, not its rounding."""
    sensors = np.stack([sensor_of(model, channel) for channel in OUTPUTS])
    sensors[:, SENSOR_STEP] = 0.0
    return sensors
