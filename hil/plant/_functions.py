"""Replays one torque through transfer functions with many sets of effects before and behind them.

Dead time and lag of the path are put into the functions, and so are exact.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from hil.core.chain import Chain
from hil.core.channels import OUTPUTS
from hil.core.model import TransferFunction
from hil.plant import slots as P
from hil.plant._torque_path import shape
from hil.plant._transfer_function import respond
from hil.plant.sensors import record

Array = npt.NDArray[np.float64]


def respond_many(
    functions: Mapping[str, TransferFunction],
    parameters: Array,
    torque_nm: Array,
    dt: float,
    starts: Array,
    sensors: Array,
    block: int,
) -> Array:
    """What `simulate_many` gives, of functions behind the torque paths of `parameters`; 0 without a function.

    Args:
        starts: sets x 3 or more: the outputs at the beginning, in their own units.
    """
    out = np.zeros((len(parameters), len(torque_nm) // block, len(OUTPUTS)))
    torque = np.ascontiguousarray(torque_nm, dtype=float)
    driven: dict[bytes, Array] = {}  # sets of one fit differ mostly in starts and sensors
    free = {
        name: respond(replace(function, delay_s=0.0), np.zeros_like(torque), dt, 1.0)
        for name, function in functions.items()
    }
    for index, path in enumerate(parameters):
        key = path.tobytes()
        if key not in driven:
            driven[key] = _driven(functions, path, torque, dt)
        for column, name in enumerate(OUTPUTS):
            if name in functions:
                truth = driven[key][:, column] + starts[index, column] * free[name]
                record(truth, sensors[index, column], dt, block, out[index, :, column])
    return out


def _driven(functions: Mapping[str, TransferFunction], path: Array, torque: Array, dt: float) -> Array:
    """Outputs from rest (samples x 3) behind a torque path, packed as `pack` does."""
    acting = np.empty_like(torque)
    shape(torque, dt, path, acting, np.empty_like(torque))
    numbers = Chain(*path[: P.CHAIN].tolist())
    out = np.zeros((len(torque), len(OUTPUTS)))
    for column, name in enumerate(OUTPUTS):
        if name in functions:
            function = functions[name]
            delayed = replace(
                function,
                denominator=tuple(np.polymul(function.denominator, [numbers.torque_lag, 1.0]).tolist()),
                delay_s=max(0.0, function.delay_s + numbers.torque_delay - P.PATH_DELAY_S),
            )
            out[:, column] = respond(delayed, acting, dt, 0.0)
    return out
