"""Orders of the wheel: what joints, tyres and imbalance excite at multiples of its revolutions.

They are followed along the wheel's angle (order tracking: Fyfe and Munck, Analysis of computed order
tracking, MSSP 11(2), 1997). Below the resonance the torque that a motor makes arrives at the shafts as
N T_m: an order that lies in N T_m as well is made by the motor, thus by the control loop, and is not the
wheel's.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import numpy.typing as npt

from hil.core.channels import TIME
from hil.core.recording import Recording
from hil.core.result import Segment
from test_plans.conductor import Array
from test_plans.metrics._low_pass import hann, without_trend
from test_plans.metrics._metric import NoValueError
from test_plans.metrics._samples import cut, evenly

_FOLLOWED_S = 2.0  # over which an order's amplitude is taken, where the signal is as long
_LEAST_TURNS = 2.0  # of an order in that time: slower ones are no ripple that could be followed
_OF_THE_MOTOR = 0.5  # of an order: what N T_m has of it within this share was made by the motor
_LEAST_KNOWN = 0.5  # of the samples of a channel beside
_WHEEL, _MOTOR = "wheel_speed_rad_s", "motor_torque_nm"


def orders_removed(
    recording: Recording, segment: Segment, channel: str, start_s: float, end_s: float
) -> tuple[float, Array]:
    """Sample time, and a channel between two times without the orders that its bench file declares.

    Raises:
        NoValueError: samples are missing.
    """
    time, values = cut(recording, segment, channel, start_s, end_s, with_end=False)
    spacing_s, even = evenly(time, values)
    if not segment.wheel_orders or channel == _MOTOR:
        return spacing_s, even
    speed = _beside(recording, _WHEEL, time)
    made = None
    if segment.gear_ratio is not None and _MOTOR in recording:
        made = segment.gear_ratio * _beside(recording, _MOTOR, time)
    return spacing_s, without_orders(even, spacing_s, speed / (2 * np.pi), segment.wheel_orders, made)


def _beside(recording: Recording, channel: str, time: Array) -> Array:
    """Another channel at some times; what a lost frame has left out lies between its neighbours."""
    first, last = recording.rows_before(float(time[0])), recording.rows_before(float(time[-1]), or_at=True)
    rows = recording.rows(first, last, (TIME, channel))
    known = np.isfinite(rows[channel])
    if np.count_nonzero(known) < _LEAST_KNOWN * len(time):
        raise NoValueError(f"most samples of {channel} are missing in the window")
    return np.interp(time, rows[TIME][known], rows[channel][known])


def without_orders(
    values: Array, spacing_s: float, turns_hz: Array, orders: Iterable[float], of_motor: Array | None = None
) -> Array:
    """A signal without declared orders of the wheel, of shape (n,).

    Args:
        values: shape (n,), every `spacing_s`.
        turns_hz: the wheel's revolutions a second at the same samples, shape (n,).
        orders: multiples of the wheel's revolutions.
        of_motor: what the motor makes there in the signal's unit (N T_m), if it is known: an order that it
            makes itself is a cycle of the loop, and stays.
    """
    count = len(values)
    angle: Array = np.zeros(count)
    angle[1:] = spacing_s * np.cumsum(0.5 * (turns_hz[1:] + turns_hz[:-1]))
    trend = values - without_trend(values)
    left = values - trend
    made = None if of_motor is None else without_trend(of_motor)
    followed_s = min(_FOLLOWED_S, count * spacing_s)
    length = round(followed_s / spacing_s)
    for order in orders:
        turning: npt.NDArray[np.complex128] = np.exp(-2j * np.pi * order * angle)
        envelope = _envelope(left, turning, length)
        if made is not None:
            apart = np.linalg.norm(envelope - _envelope(made, turning, length))
            if apart < _OF_THE_MOTOR * np.linalg.norm(envelope):
                continue
        fast = np.abs(order * turns_hz) * followed_s >= _LEAST_TURNS
        left = left - np.where(fast, (envelope * np.conj(turning)).real, 0.0)
    return np.asarray(left + trend)


def _envelope(values: Array, turning: npt.NDArray[np.complex128], length: int) -> npt.NDArray[np.complex128]:
    """Complex amplitude of the line whose phase `turning` takes back, smoothed over `length` samples."""
    kernel = hann(length)
    size = 1 << int(len(values) + length - 1).bit_length()

    def smoothed(signal: npt.NDArray[np.complex128]) -> npt.NDArray[np.complex128]:
        product = np.fft.fft(signal, size) * np.fft.fft(kernel, size)
        whole = np.fft.ifft(product)[: len(signal) + length - 1]
        return np.asarray(whole[(length - 1) // 2 :][: len(signal)])

    weight = smoothed(np.ones(len(values), complex)).real
    return np.asarray(2.0 * smoothed(values * turning) / np.maximum(weight, 1e-12))
