"""Channels that hold a value for a while, exactly or with noise, as the axle goes on moving.

Standing still is no fault of a channel: dry friction holds a rotor, a dyno holds a wheel. But motor and wheel
turn by the same angle but for play and twist; and where shaft torque stays, speeds change evenly.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data.broken_channels import coarse
from hil.analysis.diagnosis.data.thresholds import (
    BELOW_STEPS,
    FREEZE_WINDOWS_S,
    HOLDS_NOISE,
    HOLDS_SHARE,
    PLAY_RAD,
    SLOW_S,
    TURNS_ON,
)
from hil.analysis.diagnosis.data.trace import Trace
from hil.analysis.diagnosis.data.turns import around
from hil.core.channels import INPUT, OUTPUTS
from hil.core.errors import BadInputError
from hil.core.model import Model
from hil.plant import gear_ratio_of, rounding_step

Array = npt.NDArray[np.float64]


def refuse_frozen(trace: Trace, noise: Array, model: Model) -> None:
    """Refuse a channel that stops for a while as the others go on.

    Args:
        noise: standard deviation of each output per sample, shape (3,).
        model: its gear ratio, the stiffness of its shafts and its motor's inertia are used, roughly.

    Raises:
        BadInputError: names the channel, the recording and the stretch.
    """
    step = trace.dt * trace.block
    gear_ratio = gear_ratio_of(model) or 1.0
    stiffness = model.parameters.get("shaft_stiffness", np.inf)
    inertia = model.parameters.get("motor_inertia", 0.0)
    scale = np.array([1.0 / gear_ratio, 1.0, 1.0])
    values = trace.measured * scale
    torque = trace.torque[: len(values) * trace.block].reshape(len(values), trace.block).mean(axis=1)
    pulls = _shaft_torque(torque, trace.measured[:, 0], step, inertia) * gear_ratio
    moves = np.std(values, axis=0)
    holds = np.maximum(HOLDS_NOISE * noise * scale / np.sqrt(trace.block), HOLDS_SHARE * moves)
    steps = np.array(
        [BELOW_STEPS * rounding_step(trace.samples[:, c]) if trace.has[c] else 0.0 for c in range(3)]
    )
    fine = np.array([bool(trace.has[c]) and not coarse(trace, c) for c in range(3)])
    for seconds in FREEZE_WINDOWS_S:
        length = round(seconds / step)
        for first in range(0, len(values) - length + 1, max(1, length // 4)):
            inside = slice(first, first + length)
            part = values[inside]
            still = fine & (np.std(part, axis=0) < holds) & (moves > 5.0 * holds)
            for column in np.flatnonzero(still).tolist():
                least = max(float(steps[column] * scale[column]), 10.0 * float(holds[column]))
                if column == 2:
                    other = _on_by_torque(part, torque[inside] * gear_ratio, trace, least, moves, holds)
                else:
                    apart = PLAY_RAD + float(np.std(pulls[inside])) / stiffness
                    other = _on_by_turning(part[:, 1 - column], 1 - column, step, least, apart)
                if other:
                    begin, end = _stretch(values[:, column], first, length, float(holds[column]))
                    raise BadInputError(
                        f"{OUTPUTS[column]} looks frozen: it reads "
                        f"{float(np.mean(trace.measured[inside, column])):.4g} from {begin * step:.4g} s "
                        f"to {end * step:.4g} s, as {other} moves on",
                        where=trace.source,
                        fix="repair the channel, or cut this part out of the recording",
                    )


def _shaft_torque(torque: Array, motor_speed: Array, step: float, inertia: float) -> Array:
    """What a motor gives to the shafts: its torque, and at a resonance far more by its rotor's inertia."""
    return torque - inertia * np.gradient(motor_speed, step)


def _on_by_turning(other: Array, column: int, step: float, least: float, apart: float) -> str:
    """The other speed, where it turns further than play and twist allow; even change may be drift."""
    about = around(1, other)
    turned = around(2, _slow(np.cumsum(other) * step, step))
    return OUTPUTS[column] if np.std(turned) > apart and np.std(about) > least else ""


def _on_by_torque(part: Array, torque: Array, trace: Trace, least: float, moves: Array, holds: Array) -> str:
    """The torque, where it moves and a speed answers by other than even change."""
    slow = _slow(torque, trace.dt * trace.block)  # a rotor that rattles in play takes the rest
    if np.std(slow) < max(least, TURNS_ON * float(moves[2])):
        return ""
    for column in (0, 1):
        if trace.has[column]:
            uneven = around(1, part[:, column])
            if np.std(uneven) > max(5.0 * float(holds[column]), 0.2 * TURNS_ON * float(moves[column])):
                return INPUT
    return ""


def _slow(values: Array, step: float) -> Array:
    count = max(1, round(SLOW_S / 2 / step))
    return np.convolve(values, np.ones(count) / count, "valid")


def _stretch(values: Array, first: int, length: int, holds: float) -> tuple[int, int]:
    """The stretch around a window that stays near its mean."""
    near = np.abs(values - np.mean(values[first : first + length])) < 6.0 * holds
    before = np.flatnonzero(~near[:first])
    after = np.flatnonzero(~near[first + length :])
    begin = int(before[-1]) + 1 if before.size else 0
    return begin, first + length + int(after[0]) if after.size else len(values)
