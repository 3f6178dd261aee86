"""Poles of the closed loop as the RMCU closes it: exact, so that no grid of frequencies can miss one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import linalg

from hil.core.errors import BadInputError
from hil.core.model import TransferFunction
from hil.plant.controller.filters import discretised

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_ROUNDING = 1e-9  # of a sample: a dead time this near to whole samples is whole


@dataclass(frozen=True)
class _StateSpace:
    a: Array
    b: Array
    c: Array
    d: float


def closed_loop_poles(
    plant: TransferFunction, blocks: Sequence[TransferFunction], sample_time_s: float
) -> ComplexArray:
    """Poles in z of plant and feedback: zero-order hold with the plant's dead time, blocks by Tustin's rule.

    The loop is stable when all lie inside the unit circle. State space throughout: the poles near z = 1
    are lost to rounding in a product of polynomials.

    Args:
        plant: motor speed over motor torque, proper, with its dead time in s.
        blocks: the feedback in series.
        sample_time_s: of the RMCU, s.

    Raises:
        BadInputError: the model's numbers are too far apart for floating point.
    """
    try:
        with np.errstate(all="ignore"):
            held = _held(plant, sample_time_s)
            control = _in_series([_by_tustin(block, sample_time_s) for block in blocks])
            return np.asarray(linalg.eigvals(_closed(held, control)), complex)
    except (ValueError, np.linalg.LinAlgError, OverflowError) as error:
        raise BadInputError(
            "the closed loop cannot be computed: the model's numbers are too large or too small",
            fix="check the units of the model's coefficients",
        ) from error


def _held(plant: TransferFunction, step: float) -> _StateSpace:
    """The plant from one command of the RMCU to the speed at the next samples, dead time as states."""
    from scipy.signal import tf2ss

    whole = plant.delay_s / step
    late = int(np.floor(whole + _ROUNDING))
    rest = max(0.0, whole - late) * step
    a, b, c, d = tf2ss(plant.numerator, plant.denominator)
    even, scale = linalg.matrix_balance(a)
    balanced: Array = np.asarray(even, float)
    entering: Array = np.asarray(np.linalg.solve(scale, b), float)
    leaving = c @ scale
    after, new = _advanced(balanced, entering, step - rest)
    through, old = _advanced(balanced, entering, rest)
    order, size = len(a), len(a) + late + 1
    # states: the plant's, then the commands of one, two, ... samples ago
    matrix, entry, reading = np.zeros((size, size)), np.zeros((size, 1)), np.zeros((1, size))
    matrix[:order, :order] = after @ through
    matrix[:order, order + late] = (after @ old)[:, 0]
    reading[0, :order] = leaving[0]
    if late:
        matrix[:order, order + late - 1] = new[:, 0]
    else:
        entry[:order] = new
    entry[order] = 1.0
    matrix[order + 1 :, order:-1] = np.eye(late)
    direct = float(d[0, 0])
    seen = late if rest > 0 else late - 1  # which earlier command acts at the instant of sampling
    if seen >= 0:
        reading[0, order + seen] = direct
    return _StateSpace(matrix, entry, reading, direct if seen < 0 else 0.0)


def _advanced(a: Array, b: Array, duration_s: float) -> tuple[Array, Array]:
    """exp(A t), and the effect of a constant input over t."""
    order = len(a)
    block = np.zeros((order + 1, order + 1))
    block[:order, :order], block[:order, order:] = a * duration_s, b * duration_s
    whole = linalg.expm(block)
    return whole[:order, :order], whole[:order, order:]


def _by_tustin(block: TransferFunction, step: float) -> _StateSpace:
    from scipy.signal import tf2ss

    a, b, c, d = tf2ss(*discretised(block.numerator, block.denominator, step))
    return _StateSpace(a, b, c, float(d[0, 0]))


def _in_series(parts: Sequence[_StateSpace]) -> _StateSpace:
    first, *others = parts
    for second in others:
        a = np.block([[first.a, np.zeros((len(first.a), len(second.a)))], [second.b @ first.c, second.a]])
        b = np.vstack([first.b, second.b * first.d])
        first = _StateSpace(a, b, np.hstack([second.d * first.c, second.c]), first.d * second.d)
    return first


def _closed(plant: _StateSpace, control: _StateSpace) -> Array:
    """State matrix of both with the speed fed back negatively."""
    share = 1.0 / (1.0 + plant.d * control.d)
    command = share * np.hstack([-control.d * plant.c, control.c])
    reading = np.hstack([plant.c, np.zeros((1, len(control.a)))]) + plant.d * command
    size = len(plant.a)
    matrix = linalg.block_diag(plant.a, control.a)
    matrix[:size] += plant.b @ command
    matrix[size:] -= control.b @ reading
    return np.asarray(matrix, float)
