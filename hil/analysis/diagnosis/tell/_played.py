"""Models played through one torque side by side, by the kernel that fits use."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.fit._coordinates import sensors_of
from hil.core.model import Model
from hil.plant import gear_ratio_of, pack, simulate_many

Array = npt.NDArray[np.float64]


def played(models: Sequence[Model], torque: Array, step: float, wheel_speed: float) -> Array:
    """Outputs in the order of `OUTPUTS`, models x samples x 3; 0 for one that a model does not have.

    Args:
        models: with the same transfer functions, if with any.
        torque: shape (n,), N m, held for `step` seconds each; none has acted before.
        wheel_speed: at the start, in rad/s, no torque in the shafts.
    """
    slots, sensors = np.stack([pack(model) for model in models]), np.stack([sensors_of(m) for m in models])
    starts = [(wheel_speed * (gear_ratio_of(model) or 1.0), wheel_speed, 0.0) for model in models]
    from_rest = np.concatenate([[0.0], torque])
    functions = models[0].transfer_functions
    return simulate_many(slots, from_rest, step, np.array(starts), sensors, functions=functions)[:, 1:]
