"""Orders of turning in what the model leaves unexplained: one Fourier transform over angle.

A ripple torque at order o adds G(o·speed)·exp(i·o·angle) to every channel. Correlating the weighted error
with that for every o at once: the error goes through the adjoint of G in the frequency domain, is sorted
into bins of angle, and is Fourier transformed over angle (order tracking by resampling, turned around).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data.trace import blocks
from hil.analysis.diagnosis.fit.fit import Fit
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.search.thresholds import (
    BINS_A_TURN,
    FROM_HZ,
    LARGEST_ORDER,
    LEAST_ANGLE_RAD,
    LEAST_ORDER,
    ORDER_GRID,
    SPEED_BINS,
)
from hil.plant import LinearSystem, linear_system

Array = npt.NDArray[np.float64]
Spectrum = npt.NDArray[np.complex128]


@dataclass(frozen=True)
class OrderLine:
    """One order found: `score` is about the drop of the sum of squared errors that it buys."""

    side: Literal["wheel", "motor"]
    order: float
    score: float


def order_lines(
    problem: Problem, fit: Fit, side: Literal["wheel", "motor"], most: int = 2
) -> list[OrderLine]:
    """The strongest orders of the wheel's or the rotor's turning in the errors of `fit`, strongest first."""
    if problem.functions:  # they do not say what a torque on the shafts would show
        return []
    angles, images, powers, speeds = [], [], [], []
    system = linear_system(fit.hypothesis.model(fit.theta))
    for index, trace in enumerate(problem.traces):
        error = fit.errors[index].channels
        dt = trace.dt * trace.block
        turned = problem.angles[index][:, 0 if side == "wheel" else 1]
        angle = blocks(turned[:, None], trace.block)[:, 0]
        speed = np.gradient(angle, dt)
        image, frequency, power = _adjoint(
            system, error * problem.weights[index], problem.weights[index], dt, side
        )
        angles.append(angle)
        images.append(image)
        speeds.append(speed)
        powers.append((frequency, power))
    reach = max(float(np.ptp(a)) for a in angles)
    if reach < LEAST_ANGLE_RAD:
        return []
    spectrum, orders = _over_angle(angles, images, LARGEST_ORDER[side])
    energy = _expected(orders, speeds, powers)
    # a bias of the start and slow drifts live at low orders: an order must turn a few times; and what
    # turns with a shaft repeats with every turn
    usable = (orders * reach > 8 * np.pi) & (orders > LEAST_ORDER)
    score = np.where(usable & (energy > 0), 2.0 * np.abs(spectrum) ** 2 / np.maximum(energy, 1e-12), 0.0)
    return _peaks(score, orders, side, most, 2 * np.pi / reach)


def _adjoint(
    system: LinearSystem, error: Array, weights: Array, dt: float, side: str
) -> tuple[Array, Array, Array]:
    """The error seen from the ripple's input, and the weighted power of the response over frequency."""
    size = len(error)
    frequency = np.asarray(np.fft.rfftfreq(size, dt), dtype=float)
    inside = (frequency >= FROM_HZ) & (frequency <= 60.0)
    responses = _responses(system, frequency[inside], side)
    spectrum = np.fft.rfft(error, axis=0)
    image = np.zeros(len(frequency), complex)
    image[inside] = np.sum(np.conj(responses) * spectrum[inside], axis=1)
    power = np.zeros(len(frequency))
    power[inside] = np.sum(np.abs(responses) ** 2 * weights**2, axis=1)
    return np.fft.irfft(image, size), frequency, power


def _responses(system: LinearSystem, frequency: Array, side: str) -> Spectrum:
    """Motor speed, wheel speed and shaft torque per N m of ripple: frequencies x 3."""
    if side == "wheel":
        return np.asarray(system.response(frequency, "extra_shaft_torque_nm").T)
    return np.asarray(-system.response(frequency, "rotor_loss_nm").T)


def _over_angle(angles: list[Array], images: list[Array], largest: float) -> tuple[Spectrum, Array]:
    low = min(float(a.min()) for a in angles)
    high = max(float(a.max()) for a in angles)
    width = 2 * np.pi / (largest * BINS_A_TURN)
    count = int(2 ** np.ceil(np.log2(2 * (high - low) / width + 1)))
    bins = np.zeros(count)
    for angle, image in zip(angles, images, strict=True):
        bins += np.bincount(np.floor((angle - low) / width).astype(int), image, count)
    spectrum = np.asarray(np.conj(np.fft.rfft(bins)), dtype=np.complex128)
    orders = np.asarray(2 * np.pi * np.arange(len(spectrum)) / (count * width), dtype=float)
    keep = orders <= largest
    return spectrum[keep], orders[keep]


def _expected(orders: Array, speeds: list[Array], powers: list[tuple[Array, Array]]) -> Array:
    """Sum over samples of the response's power at the frequency that each order has there."""
    coarse = np.linspace(0.0, float(orders[-1]), ORDER_GRID)
    total = np.zeros(ORDER_GRID)
    for speed, (frequency, power) in zip(speeds, powers, strict=True):
        counts, edges = np.histogram(np.abs(speed), SPEED_BINS)
        middle = 0.5 * (edges[1:] + edges[:-1])
        at = coarse[:, None] * middle / (2 * np.pi)
        total += np.interp(at.ravel(), frequency, power, right=0.0).reshape(at.shape) @ counts
    return np.interp(orders, coarse, total)


def _peaks(
    score: Array, orders: Array, side: Literal["wheel", "motor"], most: int, apart: float
) -> list[OrderLine]:
    found: list[OrderLine] = []
    left = score.copy()
    for _ in range(most):
        top = int(np.argmax(left))
        if left[top] <= 0.0:
            break
        found.append(OrderLine(side, float(orders[top]), float(left[top])))
        left[np.abs(orders - orders[top]) < 4 * apart] = 0.0
    return found
