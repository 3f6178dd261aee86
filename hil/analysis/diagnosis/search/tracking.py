"""Phase of a ripple over time, stated by the ripple itself wherever it wanders.

An angle integrated from a noisy speed is a random walk; a high order turns that into whole turns of phase, in
which no search by slopes finds its way. So each short window of a recording says how well every phase fits,
and the likeliest walk through all windows is found by dynamic programming (Viterbi), as a tracking
tachometer does (Vold and Leuridan's order tracking, with a phase in place of an amplitude).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.linalg import LinAlgError, solveh_banded

from hil.analysis.diagnosis.fit.coordinates import Hypothesis, sensors_of
from hil.analysis.diagnosis.fit.fit import Fit, started_from
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.search.thresholds import (
    KNOWN_STEP,
    LEAST_STEP,
    NO_RIPPLE,
    PHASES,
    REFINED,
    RIPPLE_DIVERGED,
    SLOW_NOISE,
    SOON_S,
    START_RAD,
    WINDOW_S,
)
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse, Model
from hil.plant import pack, simulate_many

Array = npt.NDArray[np.float64]

#: Ripples, and the column of the angles (wheel, rotor) and of the channels that each follows.
RIPPLES = {
    effect.id: (0, 1) if effect.law.follows == "wheel" else (1, 0)
    for effect in EFFECTS.values()
    if effect.law.follows is not None
}
_GRID = 2.0 * np.pi / PHASES


@dataclass(frozen=True)
class _Windows:
    """What each window of one recording says of a phase: products of the ripple's sine and cosine.

    `own` is windows x 2 x 2, `seen` windows x 2, `times` (s) and `angle` (rad) are at the windows' middles.
    """

    own: Array
    seen: Array
    times: Array
    angle: Array


def track(
    problem: Problem,
    hypothesis: Hypothesis,
    theta: Array,
    starts: list[Array],
    *,
    order_known: bool = False,
    phase_known: bool = False,
) -> tuple[Array, Problem]:
    """Turn the angles of every recording to where the ripples of `hypothesis` say.

    Those of the base model are known; what differs there is drift of the angles.

    Args:
        order_known, phase_known: those of `theta` are right as well.

    Returns:
        `theta` with what all recordings have in common put into order and phase, where these are not known;
        and the problem with the turned angles.
    """
    theta = theta.copy()
    coordinates = hypothesis.coordinates()
    before = len(hypothesis.base.effects)
    for position, use in enumerate((*hypothesis.base.effects, *hypothesis.terms)):
        if use.id not in RIPPLES:
            continue
        model = hypothesis.model(theta)
        column = RIPPLES[use.id][0]
        term = position - before  # negative: of the base model, which knows its order and phase
        order = float(model.effects[position].values["order"])
        windows = [_windows(problem, model, position, index, start) for index, start in enumerate(starts)]
        paths = []
        for index, one in enumerate(windows):
            begin = START_RAD if (phase_known if term >= 0 else angle_known(problem, index)) else np.inf
            step = _step(problem, model.effects[position], index, LEAST_STEP if term >= 0 else KNOWN_STEP)
            paths.append(_likeliest(one, step, begin))
        more = 0.0 if order_known or term < 0 else _common_order(windows, paths)
        turn = 0.0 if phase_known or term < 0 else _common_phase(windows, paths, order, more)
        angles = []
        for index, (one, path) in enumerate(zip(windows, paths, strict=True)):
            drift = path - turn - more * one.angle
            drift -= 2.0 * np.pi * np.round(drift[0] / (2.0 * np.pi))
            angles.append(_turned(problem, index, column, one.times, drift / (order + more)))
        problem = problem.with_angles(angles)
        for i, c in enumerate(coordinates):
            if c.term == term and c.name in ("order", "phase_rad"):
                theta[i] += more if c.name == "order" else turn
    return theta, problem


def angle_known(problem: Problem, index: int) -> bool:
    """Whether a recording's angle counts from the bench's own zero, as the phases of a model do."""
    counted = problem.resting[index] or problem.traces[index].first_wheel_angle_rad != 0.0
    return problem.zero_known and counted


def _turned(problem: Problem, index: int, column: int, times: Array, drift: Array) -> Array:
    """A recording's angles with a drift in rad, given at `times` in s, added to one column."""
    trace = problem.traces[index]
    angles = problem.angles[index].copy()
    angles[:, column] += np.interp(np.arange(len(trace.torque)) * trace.dt, times, drift)
    return angles


def tracked_gain(problem: Problem, parent: Fit, use: EffectUse) -> float:
    """Drop of the squared error that a ripple promises on top of `parent` if its phase is followed."""
    hypothesis = parent.hypothesis.with_term(use)
    model = hypothesis.model(started_from(parent, hypothesis))
    seen, own = 0.0, 0.0
    for index, start in enumerate(parent.starts):
        windows = _windows(problem, model, len(model.effects) - 1, index, start)
        path = _likeliest(windows, _step(problem, model.effects[-1], index, LEAST_STEP), np.inf)
        turned = np.stack([np.cos(path), np.sin(path)], axis=1)
        seen += float(np.sum(windows.seen * turned))
        own += float(np.einsum("wa,wab,wb->", turned, windows.own, turned))
    return max(seen, 0.0) ** 2 / max(own, 1e-12)


def _step(problem: Problem, use: EffectUse, index: int, least: float) -> float:
    """Variance of a ripple's phase from window to window, rad², for the noise of the speed it follows.

    Args:
        least: standard deviation in a second, rad, that the order may be off by.
    """
    noise = _followed_noise(problem, RIPPLES[use.id][1], index)
    walk = float(use.values["order"]) ** 2 * noise**2 * SLOW_NOISE * problem.traces[index].dt
    return max(walk, least**2) * WINDOW_S


def _followed_noise(problem: Problem, channel: int, index: int) -> float:
    """Noise of a speed (0 motor, 1 wheel), rad/s, as `Trace.angles` has it: from the other if missing."""
    has = problem.traces[index].has
    if has[channel]:
        return float(problem.floor[channel])
    if has[1 - channel]:
        ratio = problem.gear_ratio if channel == 0 else 1.0 / problem.gear_ratio
        return float(problem.floor[1 - channel]) * ratio
    return 0.0  # no speed was measured: the angle stays at zero


def _windows(problem: Problem, model: Model, position: int, index: int, start: Array) -> _Windows:
    trace = problem.traces[index]
    use = model.effects[position]
    phase = float(use.values["phase_rad"])
    sets = []
    for amplitude, turned in ((NO_RIPPLE, phase), (None, phase), (None, phase + np.pi / 2)):
        values = {**use.values, "phase_rad": turned}
        if amplitude is not None:
            values["amplitude_nm"] = amplitude
        effects = list(model.effects)
        effects[position] = EffectUse(use.id, values)
        sets.append(pack(model.with_effects(*effects)))
    sensors = np.tile(sensors_of(model), (3, 1, 1))
    around = simulate_many(
        np.stack(sets),
        trace.torque,
        trace.dt,
        np.tile(start, (3, 1)),
        sensors,
        trace.block,
        problem.angles[index],
        trace.load,
    )
    error = problem.errors(index, around[0])
    ripple = problem.changes(index, around)
    # Where a simulation diverges nothing is known of a phase, and NaN would spread over the whole walk.
    ripple[~(np.abs(ripple) < RIPPLE_DIVERGED)] = 0.0
    period = trace.dt * trace.block
    length = max(4, round(WINDOW_S / period))
    count = max(1, len(error) // length)
    length = min(length, len(error))
    line = np.linalg.qr(np.column_stack([np.ones(length), np.linspace(-1.0, 1.0, length)]))[0]

    def cut(values: Array) -> Array:
        """Windows x rows x channels; a speed without its straight line, which earlier windows gave it."""
        parts = values[: count * length].reshape(count, length, 3).copy()
        parts[:, :, :2] -= line @ (line.T @ parts[:, :, :2])
        return parts

    parts = np.stack([cut(one) for one in ripple])
    by_window = parts.swapaxes(0, 1).reshape(count, len(parts), -1)  # rows of all channels in one
    own = by_window @ by_window.swapaxes(1, 2)
    seen = (by_window @ cut(error).reshape(count, -1, 1))[:, :, 0]
    middles = (np.arange(count) + 0.5) * length
    samples = np.minimum((middles * trace.block).astype(int), len(trace.torque) - 1)
    angle = problem.angles[index][samples, RIPPLES[use.id][0]]
    return _Windows(own, seen, np.asarray(middles * period, dtype=float), angle)


def _likeliest(windows: _Windows, step: float, start: float) -> Array:
    """The likeliest phase (rad, unwrapped) in each window.

    Args:
        step: variance of the phase from window to window, rad².
        start: standard deviation of the first one around zero, rad.
    """
    phases = 2.0 * np.pi * np.arange(PHASES) / PHASES
    turned = np.stack([np.cos(phases), np.sin(phases)])
    along = windows.seen @ turned
    own = np.einsum("ap,wab,bp->wp", turned, windows.own, turned)
    between = np.abs(np.angle(np.exp(1j * (phases[:, None] - phases[None, :]))))
    moves = between**2 / step
    path = np.zeros(len(along), int)
    size = 1.0
    for _ in range(2):
        costs = size**2 * own - 2.0 * size * along
        total = costs[0] + between[0] ** 2 / start**2
        came_from = np.zeros(along.shape, int)
        for w in range(1, len(costs)):
            sums = total[:, None] + moves
            came_from[w] = np.argmin(sums, axis=0)
            total = sums[came_from[w], np.arange(PHASES)] + costs[w]
        path[-1] = int(np.argmin(total))
        for w in range(len(costs) - 1, 0, -1):
            path[w - 1] = came_from[w, path[w]]
        at = np.arange(len(path))
        size = max(float(np.sum(along[at, path])) / max(float(np.sum(own[at, path])), 1e-12), 0.1)
    return _smoothed(windows, np.unwrap(phases[path]), size, step)


def _smoothed(windows: _Windows, path: Array, size: float, step: float) -> Array:
    """`path` moved off the grid of phases to the likeliest one near to it (Gauss-Newton)."""
    bands = np.zeros((2, len(path)))
    bands[0, 1:] = -1.0 / step
    stiff = np.full(len(path), 2.0 / step)
    stiff[[0, -1]] -= 1.0 / step
    for _ in range(REFINED):
        turned = np.stack([np.cos(path), np.sin(path)], axis=1)
        across = np.stack([-turned[:, 1], turned[:, 0]], axis=1)
        left = windows.seen - size * np.einsum("wab,wb->wa", windows.own, turned)
        pull = size * np.sum(across * left, axis=1)
        bands[1] = size**2 * np.einsum("wa,wab,wb->w", across, windows.own, across) + stiff + 1e-9
        steps = np.diff(path) / step
        pull[:-1] += steps
        pull[1:] -= steps
        if not (np.isfinite(bands).all() and np.isfinite(pull).all() and bands[1].min() > 0.0):
            break  # numbers beyond a double's range: the grid's phase is as good as any
        try:
            moved = solveh_banded(bands, pull)
        except LinAlgError:  # not positive definite to its last digits
            break
        path = path + np.clip(np.nan_to_num(moved), -_GRID, _GRID)
    return np.asarray(path)


def _common_order(windows: list[_Windows], paths: list[Array]) -> float:
    """Correction of the order that all recordings say together."""
    turned = sum(float(np.sum(np.diff(one.angle) ** 2)) for one in windows)
    moved = sum(float(np.diff(w.angle) @ np.diff(p)) for w, p in zip(windows, paths, strict=True))
    return moved / turned if turned > 0.0 else 0.0


def _common_phase(windows: list[_Windows], paths: list[Array], order: float, more: float) -> float:
    """Correction of the phase in rad that all recordings say together, the order corrected by `more`.

    A ripple that has not turned yet looks like friction or an offset: the sooner a recording turns it, the
    more its phase says.
    """
    together = 0.0 + 0.0j
    for one, path in zip(windows, paths, strict=True):
        whole = np.abs(one.angle - one.angle[0]) * order > 2.0 * np.pi
        if whole.any():
            weight = 1.0 / (SOON_S + float(one.times[np.argmax(whole)]))
            together += weight * np.exp(1j * (path[0] - more * one.angle[0]))
    return float(np.angle(together)) if together else 0.0
