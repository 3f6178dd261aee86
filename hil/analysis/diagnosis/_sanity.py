"""Data that no physics can explain: refused by name before anything is fitted."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis._trace import Trace
from hil.core.channels import OUTPUTS
from hil.core.errors import BadInputError
from hil.core.model import Model

Array = npt.NDArray[np.float64]

_INVERTED = -0.5
_RATIO_OFF = 0.3
_CLIPPED_SHARE = 0.03
_MOVES = 5.0  # noise levels


def check(model: Model, traces: list[Trace], noise: Array) -> list[str]:
    """Refuse recordings that cannot belong to the model; what is merely odd is returned as notes.

    Raises:
        BadInputError: a channel is dead, clipped, inverted, or swapped, or the gear ratio is wrong.
    """
    if not any(float(np.ptp(t.torque)) > 0 for t in traces):
        raise BadInputError(
            "motor_torque_ref_nm never changes in any recording", fix="record a chirp or steps"
        )
    for trace in traces:
        _dead_or_clipped(trace, noise)
    ratio = model.parameters.get("gear_ratio")
    if ratio:
        _speeds(traces, ratio, noise)
        _torque(traces, ratio, noise)
    return []


def _dead_or_clipped(trace: Trace, noise: Array) -> None:
    for column in np.flatnonzero(trace.has):
        values = trace.samples[:, column]
        name = OUTPUTS[column]
        if float(np.ptp(values)) == 0.0 and float(np.ptp(trace.torque)) > 0.0:
            raise BadInputError(
                f"{name} looks dead: it reads {values[0]:g} throughout",
                where=trace.name,
                fix="mend the channel, or leave it out of the recording",
            )
        for end in (values.max(), values.min()):
            at_end = values == end
            steady = np.ptp(values) < 20 * max(float(noise[column]), 1e-12)
            if (
                np.mean(at_end) > _CLIPPED_SHARE
                and not steady
                and abs(end) > 0.2 * np.ptp(values)
                and _plateau(at_end)
            ):
                raise BadInputError(
                    f"{name} looks clipped at {end:g}: {np.mean(at_end):.0%} of its samples read this",
                    where=trace.name,
                    fix="widen the channel's range and record again",
                )


def _plateau(at_end: npt.NDArray[np.bool_]) -> bool:
    edges = np.flatnonzero(np.diff(np.concatenate([[0], at_end.astype(int), [0]])))
    return bool(np.max(edges[1::2] - edges[::2]) > 20)


def _speeds(traces: list[Trace], ratio: float, noise: Array) -> None:
    """Motor speed against wheel speed: sign, order of magnitude, ratio."""
    both = [t.measured[:, :2] for t in traces if t.has[0] and t.has[1]]
    if not both:
        return
    speeds = np.concatenate(both)
    motor, wheel = speeds[:, 0], speeds[:, 1]
    if np.std(wheel) < _MOVES * noise[1] and np.std(motor) < _MOVES * noise[0]:
        return
    slope = float(motor @ wheel / max(float(wheel @ wheel), 1e-12))
    if np.std(motor) > 0 and slope < 0 and np.corrcoef(motor, wheel)[0, 1] < _INVERTED:
        channel = _inverted_speed(traces)
        raise BadInputError(f"{channel} looks inverted", fix="turn the sign of the channel")
    if abs(slope * ratio - 1.0) < _RATIO_OFF and abs(ratio - 1.0) > _RATIO_OFF:
        raise BadInputError(
            "motor_speed_rad_s and wheel_speed_rad_s look swapped", fix="exchange the two columns"
        )
    if abs(slope / ratio - 1.0) > _RATIO_OFF:
        raise BadInputError(
            f"the gear ratio looks wrong: motor over wheel speed is {slope:.3g}, the model has {ratio:.3g}",
            fix="is it the model of another axle, or a speed in rpm?",
        )


def _inverted_speed(traces: list[Trace]) -> str:
    """The speed channel that falls when torque pushes."""
    pull = [0.0, 0.0]
    for t in traces:
        count = len(t.measured)
        torque = t.torque[: count * t.block].reshape(count, t.block).mean(axis=1)
        for column in range(2):
            rise = np.gradient(t.measured[:, column])
            pull[column] += float(np.sum((torque - torque.mean()) * rise))
    return OUTPUTS[int(np.argmin(pull))]


def _torque(traces: list[Trace], ratio: float, noise: Array) -> None:
    """Shaft torque against motor torque at low frequency: sign and order of magnitude."""
    products, squares = 0.0, 0.0
    for t in traces:
        if not t.has[2]:
            continue
        length = max(1, round(0.5 / t.dt))
        count = len(t.torque) // length
        if count < 3:
            continue
        torque = t.torque[: count * length].reshape(count, length).mean(axis=1)
        shaft = t.samples[: count * length, 2].reshape(count, length).mean(axis=1)
        products += float((torque - torque.mean()) @ (shaft - shaft.mean()))
        squares += float((torque - torque.mean()) @ (torque - torque.mean()))
    if squares <= 1e-9:
        return
    slope = products / squares / ratio
    if abs(slope) * ratio * np.sqrt(squares) < _MOVES * noise[2]:
        return
    if slope < -0.3:
        raise BadInputError("shaft_torque_nm looks inverted", fix="turn the sign of the channel")
    if not 0.3 < slope < 3.0:
        raise BadInputError(
            f"shaft_torque_nm is {slope * ratio:.3g} times the motor torque at low frequency, the model has "
            f"{ratio:.3g}",
            fix="is the channel one side only, or in another unit?",
        )
