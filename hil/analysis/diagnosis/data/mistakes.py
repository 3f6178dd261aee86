"""Units, signs and columns that were mistaken: refused where a mistake is far likelier than none.

Four pairs x, y should be alike: each output by the model and as recorded, and both speeds, that of the wheel
times the gear ratio. Over the lines of an octave, in all stretches of a file, they have a correlation ρ and a
ratio of sizes g, and are unlike by

    d = |y - x|² / (|y|² + |x|²) = 1 - ρ / cosh(ln g):  0 alike, 1 unrelated, 2 opposite.

An octave that belongs together has a small d, exponential with mean τ. With probability w it is anything,
uniform from 0 to 2: a resonance that lies elsewhere, friction, play, a drift. Sizes are free by what numbers
of a model may be off: each pair's, and one that all outputs share, as less torque may be delivered than was
asked for. A mistake turns pairs, scales them, exchanges columns, or leaves one nothing but noise; its
likelihood is compared with that of none.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data.held import apart_rad, around
from hil.analysis.diagnosis.thresholds import (
    ALIKE,
    ALIKE_SPEEDS,
    ANY_SIZE,
    ANYTHING,
    FREE_SIZE,
    GEAR_SIZE,
    LARGER_SIZE,
    LIKELIER,
    SHOWS,
    SLOW_NOISE,
    TREND,
)
from hil.analysis.missing_effects import Series
from hil.core.channels import INPUT, OUTPUTS
from hil.core.errors import BadInputError
from hil.core.errors.wording import multiple
from hil.core.model import Model
from hil.plant import gear_ratio_of, is_regulated, pack, rounding_step, sensor_of, simulate_many

Array = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]
Lines = npt.NDArray[np.complex128]

_MOTOR, _WHEEL, _SHAFT = OUTPUTS
_SPEEDS = f"{_MOTOR} and {_WHEEL}"
_GEAR = 3  # the pair of both speeds, behind those of the outputs
_EDGES_HZ = (0.0, 0.06, 0.12, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0)
_BANDS = len(_EDGES_HZ) - 1
_RPM = 60.0 / (2.0 * np.pi)
_LEAST, _FAR = 1e-30, 1e9
_STEP = 0.1
_SIZES = np.arange(-90, 91) * _STEP  # logs of factors that are tried


@dataclass(frozen=True)
class _Mistake:
    """What may have been mistaken: factors that mend torque and outputs, and an order that mends columns.

    Pairs in `free` have any size; of a channel that is `dead` only noise was recorded.
    """

    what: str
    fix: str
    torque: float = 1.0
    outputs: tuple[float, float, float] = (1.0, 1.0, 1.0)
    order: tuple[int, int, int] = (0, 1, 2)
    free: tuple[int, ...] = ()
    dead: int | None = None


_NONE = _Mistake("", "")
_AS_THEY_ARE = _NONE.order
_ORDERS = (_AS_THEY_ARE, (1, 0, 2), (2, 1, 0), (0, 2, 1))
_FALLS = "looks inverted: it falls when torque pushes"
_SIGN = f"invert the sign of the channel, or of {INPUT}"
_TO_RAD_S, _TO_NM = "multiply it by 2π/60", "multiply it by 1000"
_FITS = "check that the model belongs to this axle, and the units of the channels"
_DEAD = "looks dead: it shows only noise while the axle moves"
_REPAIR = "repair the channel, or omit it from the recordings"
_MISTAKES = (
    _Mistake(f"{_MOTOR} {_FALLS}", _SIGN, outputs=(-1.0, 1.0, 1.0)),
    _Mistake(f"{_WHEEL} {_FALLS}", _SIGN, outputs=(1.0, -1.0, 1.0)),
    _Mistake(f"{_SHAFT} looks inverted", _SIGN, outputs=(1.0, 1.0, -1.0)),
    _Mistake(f"{INPUT} looks inverted: the axle does the opposite", "invert the sign of it", torque=-1.0),
    _Mistake(f"{_SPEEDS} look inverted", "invert the sign of both", outputs=(-1.0, -1.0, 1.0)),
    *(
        _Mistake(f"{OUTPUTS[one]} and {OUTPUTS[other]} look swapped", "exchange the two columns", order=order)
        for (one, other), order in zip(((0, 1), (0, 2), (1, 2)), _ORDERS[1:], strict=True)
    ),
    _Mistake(f"{_MOTOR} looks like rpm", _TO_RAD_S, outputs=(1.0 / _RPM, 1.0, 1.0)),
    _Mistake(f"{_WHEEL} looks like rpm", _TO_RAD_S, outputs=(1.0, 1.0 / _RPM, 1.0)),
    _Mistake(f"{_SPEEDS} look like rpm", "multiply both by 2π/60", outputs=(1.0 / _RPM, 1.0 / _RPM, 1.0)),
    _Mistake(f"{_SHAFT} looks like kN m", _TO_NM, outputs=(1.0, 1.0, 1e3)),
    _Mistake(f"{INPUT} looks like kN m", _TO_NM, torque=1e3),
    _Mistake(f"{INPUT} and {_SHAFT} look like kN m", "multiply both by 1000", 1e3, (1.0, 1.0, 1e3)),
    _Mistake(
        "the gear ratio looks wrong: motor over wheel speed is {gear:.3g}, the model has {ratio:.3g}",
        _FITS,
        free=(_GEAR,),
    ),
    _Mistake(
        f"{_SHAFT} is {{2}} what the model says to the torque",
        "check its unit, and that it is on the wheel side of the gear",
        free=(2,),
    ),
    _Mistake(f"{_MOTOR} changes {{0}} as fast as the torque can make it", _FITS, free=(0,)),
    _Mistake(f"{_WHEEL} changes {{1}} as fast as the torque can make it", _FITS, free=(1,)),
    _Mistake(f"{_SPEEDS} change {{0}} as fast as the torque can make them", _FITS, free=(0, 1)),
    *(_Mistake(f"{name} {_DEAD}", _REPAIR, dead=column) for column, name in enumerate(OUTPUTS)),
)


def mistaken(model: Model, series: Sequence[Series], noise: Array) -> BadInputError | None:
    """The mistake that is beyond doubt, if there is one.

    Args:
        noise: standard deviation of each output's block means, shape (3,), NaN where it was not recorded.
    """
    recorded = [_Recorded.of(one, model, np.nan_to_num(noise)) for one in series]
    seen = {factor: _pairs(model, recorded, factor) for factor in {m.torque for m in _MISTAKES}}
    given = seen[1.0][_AS_THEY_ARE]
    known = {
        order: given.known | pairs.known for order, pairs in seen[1.0].items()
    }  # the same octaves for both
    none = {order: _log_likelihood(replace(given, known=these), _NONE) for order, these in known.items()}
    gains = [
        _log_likelihood(replace(seen[one.torque][one.order], known=known[one.order]), one) - none[one.order]
        for one in _MISTAKES
    ]
    alike = np.flatnonzero(np.array(gains) > max(gains) - np.log(2.0)).tolist()  # a tie
    best = alike[0]
    if gains[best] < np.log(LIKELIER):
        return None
    found, ratio = _MISTAKES[best], gear_ratio_of(model) or 1.0
    sizes = np.exp(given.middle_sizes())
    what = found.what.format(*(multiple(size) for size in sizes), gear=sizes[_GEAR] * ratio, ratio=ratio)
    if alike[:2] == [0, 1]:  # no torque tells which
        what = f"either {_MOTOR} or {_WHEEL} looks inverted"
    return BadInputError(what, fix=found.fix)


@dataclass(frozen=True)
class _Pairs:
    """Of each pair and octave (pairs x bands): correlation of x and y, and log of y's size over x's.

    `noisy` is the share of both powers that may be noise. `known`: one of them stands out of it. `silent`
    (2 x pairs x bands): x or y is noise where the other stands out. `turns`: a speed goes further there than
    play and twist allow.
    """

    correlation: Array
    size: Array
    noisy: Array
    known: Flags
    silent: Flags
    turns: Flags

    @classmethod
    def of(cls, sums: Array) -> _Pairs:
        """Of sums (6 x pairs x bands): |x|², |y|², Re x*y, noise in x and in y; stretches that turn far."""
        xx, yy, xy, noise_x, noise_y, turns = sums
        noise = SHOWS * np.maximum(noise_x, noise_y)
        shown = np.asarray([xx > noise, yy > noise], dtype=bool)
        silent = np.asarray([xx < 2.0 * noise_x, yy < 2.0 * noise_y], dtype=bool) & shown[::-1]
        xx, yy = np.maximum(xx, _LEAST), np.maximum(yy, _LEAST)
        noisy = SLOW_NOISE * (noise_x + noise_y) / (xx + yy)
        known = np.asarray(shown.any(axis=0), dtype=bool)
        return cls(xy / np.sqrt(xx * yy), 0.5 * np.log(yy / xx), noisy, known, silent, turns > 0.0)

    def middle_sizes(self) -> Array:
        """Log of y over x of each pair (4,), octaves weighed by their correlation."""
        weight = np.where(self.known, np.abs(self.correlation), 0.0)
        return np.asarray(np.sum(weight * self.size, axis=1) / np.maximum(np.sum(weight, axis=1), _LEAST))


_ByOrder = dict[tuple[int, int, int], _Pairs]


def _log_likelihood(pairs: _Pairs, mistake: _Mistake) -> float:
    """Log likelihood by a mistake over that of pairs that are anything; sizes are integrated over."""
    factors = [*mistake.outputs, mistake.outputs[0] / mistake.outputs[1]]
    by_size = [_by_size(pairs, pair, factor, mistake) for pair, factor in enumerate(factors)]
    width = np.where(_SIZES > 0.0, LARGER_SIZE, FREE_SIZE) / np.sqrt(2.0)
    shared = -np.abs(_SIZES) / width - np.log(np.sum(np.exp(-np.abs(_SIZES) / width)))
    outputs = float(np.logaddexp.reduce(shared + np.sum(by_size[:_GEAR], axis=0)))
    return outputs + float(by_size[_GEAR][len(_SIZES) // 2])


def _by_size(pairs: _Pairs, pair: int, factor: float, mistake: _Mistake) -> Array:
    """Log likelihood of a pair for each of `_SIZES`, which outputs share, beside a factor of its own."""
    known = pairs.known[pair]
    if mistake.dead is not None and pair in (mistake.dead, *((_GEAR,) if mistake.dead < 2 else ())):
        return np.full(len(_SIZES), _log_dead(pairs, pair, mistake.dead))
    correlation = pairs.correlation[pair, known] * np.sign(factor)
    away = pairs.size[pair, known] + np.log(abs(factor)) - _SIZES[:, None]
    alike = np.sum(_log_alike(1.0 - correlation / np.cosh(away), _usual(pairs, pair)), axis=1)
    width = ANY_SIZE if pair in mistake.free else GEAR_SIZE if pair == _GEAR else FREE_SIZE
    own = np.exp(-0.5 * (_SIZES / width) ** 2)
    most = float(np.max(alike))
    return np.asarray(np.log(np.convolve(np.exp(alike - most), own / np.sum(own), "same") + _LEAST) + most)


def _log_dead(pairs: _Pairs, pair: int, column: int) -> float:
    """Log likelihood of a pair of which a channel reads noise alone where a speed that goes with it moves.

    A speed goes with the other where that turns further than play and twist allow, or as the model says.
    """
    if column == 2:
        moves = np.asarray((pairs.known[:2] & ~pairs.silent[1, :2]).any(axis=0), dtype=bool)
    else:
        other = 1 - column
        follows = pairs.known[other] & (1.0 - pairs.correlation[other] < ALIKE)
        moves = (pairs.silent[other, _GEAR] & pairs.turns[_GEAR]) | (pairs.silent[1, column] & follows)
    dead = moves if pair == _GEAR else np.asarray(pairs.silent[1, pair] & moves, dtype=bool)
    return float(np.sum(_log_alike(np.where(dead[pairs.known[pair]], 0.0, 1.0), _usual(pairs, pair))))


def _usual(pairs: _Pairs, pair: int) -> Array:
    """How unlike what belongs together is in the mean, in octaves that are known, noise included."""
    return np.asarray((ALIKE_SPEEDS if pair == _GEAR else ALIKE) + pairs.noisy[pair, pairs.known[pair]])


def _log_alike(unlike: Array, usual: Array) -> Array:
    """Log density of how unlike a pair is in each octave, over that of anything."""
    small = 2.0 / usual * np.exp(-unlike / usual)
    return np.asarray(np.log((1.0 - ANYTHING) * small + ANYTHING))


@dataclass(frozen=True)
class _Recorded:
    """A stretch, and what hangs on no torque: its transforms `about` the trend and `whole`, as of `_Lines`.

    `tells` (3,): channels that say something; `powers` of their noise by octave; `turns` as of `_Pairs`.
    """

    series: Series
    lines: _Lines
    about: Lines
    whole: Lines
    tells: Flags
    powers: list[Array]
    turns: Flags

    @classmethod
    def of(cls, one: Series, model: Model, noise: Array) -> _Recorded:
        """Of a stretch and the noise of its block means, (3,)."""
        lines = _Lines.of(one)
        about, whole = lines.transformed(np.nan_to_num(one.measured))
        # readings of two levels move by less than their steps
        tells = one.has & [len(np.unique(values)) > 2 for values in one.samples.T]
        levels = np.where(one.of_angle, 0.0, noise).tolist()  # slow octaves of an encoder have none
        powers = [lines.noise(level, one.samples[:, column]) for column, level in enumerate(levels)]
        turned = lines.turned(whole[:, 0] / (gear_ratio_of(model) or 1.0), whole[:, 1])
        return cls(one, lines, about, whole, tells, powers, turned > apart_rad(model, one.torque))


def _pairs(model: Model, recorded: Sequence[_Recorded], torque: float) -> _ByOrder:
    """Of recordings with the torque times a factor, by orders of columns."""
    sums = np.sum([_sums(one, model, torque) for one in recorded], axis=0)
    return {order: _Pairs.of(each) for order, each in zip(_ORDERS, sums, strict=True)}


def _sums(one: _Recorded, model: Model, torque: float) -> Array:
    """What `_Pairs.of` asks for, orders of columns x 6 x pairs x bands."""
    ratio, regulated = gear_ratio_of(model) or 1.0, is_regulated(model)
    lines, whole, tells = one.lines, one.whole, one.tells
    if not regulated:
        x, shown = lines.transformed(_simulated(model, one.series, torque * one.series.torque, ratio))
        rigid = _rigid(lines, ratio * x[:, 1], x[:, 0])
        # a mean torque says something, a mean speed only how it began
        x[:, 2] = shown[:, 2]
        y = np.column_stack([one.about[:, :2], whole[:, 2]])
    found = np.zeros((len(_ORDERS), 6, _GEAR + 1, _BANDS))
    for row, order in zip(found, _ORDERS, strict=True):
        if not all(tells[column] for place, column in enumerate(order) if place != column):
            continue
        first, second, _ = order
        for pair, column in enumerate(() if regulated else order):
            if tells[column]:
                row[:3, pair], row[4, pair] = lines.sums(x[:, pair], y[:, column]), one.powers[column]
        if tells[[first, second]].all():
            together = one.turns if regulated else rigid
            row[:3, _GEAR] = together * lines.sums(ratio * whole[:, second], whole[:, first])
            row[3, _GEAR], row[4, _GEAR] = ratio**2 * one.powers[second], one.powers[first]
        row[5] = one.turns
    return found


def _rigid(lines: _Lines, wheel: Lines, motor: Lines) -> Flags:
    """Octaves in which both speeds go together by the model."""
    xx, yy, xy = lines.sums(wheel, motor)
    return np.asarray((xx + yy - 2.0 * xy <= ALIKE_SPEEDS * (xx + yy)), dtype=bool)


@dataclass(frozen=True)
class _Lines:
    """The lines of a stretch: in which octave each is, and the window of transforms."""

    frequency_hz: Array
    band: npt.NDArray[np.int64]
    window: Array

    @classmethod
    def of(cls, one: Series) -> _Lines:
        """Of block means."""
        count = len(one.measured)
        frequency = np.asarray(np.fft.rfftfreq(count, 1.0 / one.rate_hz), dtype=float)
        band = np.searchsorted(_EDGES_HZ, frequency, side="right") - 1
        return cls(frequency, band, np.hanning(count + 1)[:-1])

    def transformed(self, values: Array) -> tuple[Lines, Lines]:
        """Of channels (blocks x 3) about their trend, and with their first octave as it is."""
        both = (around(TREND, values), values)
        about, whole = (np.fft.rfft(some * self.window[:, None], axis=0) for some in both)
        return about, np.where((self.band == 0)[:, None], whole, about)

    def sums(self, x: Lines, y: Lines) -> Array:
        """Over the lines of each octave: |x|², |y|², Re x*y; 3 x bands."""
        rows = (np.abs(x) ** 2, np.abs(y) ** 2, (x.conj() * y).real)
        return np.stack([np.bincount(self.band, row, _BANDS + 1)[:_BANDS] for row in rows])

    def noise(self, level: float, values: Array) -> Array:
        """Power of a channel's noise in each octave, (bands,); that of rounded readings may be in any one."""
        count = np.bincount(self.band, minlength=_BANDS + 1)[:_BANDS]
        lines = np.maximum(count, len(self.band)) if rounding_step(values) > 0.0 else count
        return np.asarray(float(self.window @ self.window) * level**2 * lines)

    def turned(self, *speeds: Lines) -> Array:
        """Rms angle in each octave by that of some speeds that turns further, (bands,)."""
        turned = np.max(np.abs(speeds), axis=0)[1:] / (2.0 * np.pi * self.frequency_hz[1:])
        square = np.bincount(self.band[1:], turned**2, _BANDS + 1)[:_BANDS]
        return np.asarray(np.sqrt(2.0 * square / (len(self.window) * float(self.window @ self.window))))


def _simulated(model: Model, one: Series, torque: Array, ratio: float) -> Array:
    """What a model shows of a torque from a recording's start: blocks x 3, zero where it was not recorded."""
    sensors = np.stack([sensor_of(model, channel) for channel in OUTPUTS])[None]
    start, angles, functions = one.first_state(ratio)[None], one.angles(ratio), model.transfer_functions
    slots = pack(model)[None]
    shown = simulate_many(slots, torque, one.dt, start, sensors, one.block, angles, one.load, functions)[0]
    return np.where(one.has, np.clip(np.nan_to_num(shown), -_FAR, _FAR), 0.0)
