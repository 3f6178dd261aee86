"""Data that no physics can explain: refused by name before anything is fitted.

Play, twist, friction, offsets and drifts bend what two channels have to do with each other; they must not
be taken for a wrong channel. So angles are compared, not speeds (play and twist stay within a few
hundredths of a rad whatever the speed), a constant speed error is left out, and a factor is called
wrong only where every way to see it says so. A drift adds slow turns of any shape: where motion is no
faster than that, only what goes in proportion tells.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data.broken_channels import coarse, refuse_broken_channels
from hil.analysis.diagnosis.data.frozen import refuse_frozen
from hil.analysis.diagnosis.data.mistakes import mistaken
from hil.analysis.diagnosis.data.noise import noise_levels, usable_noise
from hil.analysis.diagnosis.data.slow_motion import SlowMotion, slow_motion_of, with_outputs_of
from hil.analysis.diagnosis.data.thresholds import (
    APART_RAD,
    DEAD_SHARE,
    FAST_RAD_S,
    INVERTED,
    LIKE_RPM,
    MOVES,
    NOISE_ALONE,
    RELATED,
    SLOW_S,
    SPEED_RATIO,
    TOO_FAST,
    TORQUE_OFF,
    TURNED_RAD,
)
from hil.analysis.diagnosis.data.trace import Trace, trace_of
from hil.analysis.diagnosis.data.turns import (
    Pair,
    around,
    beyond_drift,
    drift_degree,
    pushes_of,
    refused_push,
)
from hil.analysis.plausible import refuse_implausible
from hil.analysis.stretches import excerpts, unbroken
from hil.core.channels import OUTPUTS
from hil.core.errors import BadInputError
from hil.core.model import Model
from hil.core.recording import Recording
from hil.plant import is_regulated, load_of

Array = npt.NDArray[np.float64]

_MOTOR, _WHEEL, _SHAFT = OUTPUTS
_RPM = 60.0 / (2 * np.pi)
_UNRELATED = f"{_MOTOR} and {_WHEEL} are not related to each other"


def check(model: Model, traces: list[Trace], noise: Array, beside: Sequence[Trace] = ()) -> list[str]:
    """Refuse recordings that cannot belong to the model; recordings in which nothing moves make a note.

    Args:
        noise: standard deviation of each output per sample, shape (3,), NaN for a missing one.
        beside: other recordings of the same channels, that are not checked.

    Raises:
        BadInputError: a channel is dead, clipped, inverted, swapped with another or in another unit, the
            gear ratio is wrong, or nothing is excited.
    """
    notes = refuse_broken_channels(traces, noise, beside)
    if is_regulated(model):  # what turns the wheels is not recorded: motion and torque may go any way
        return notes
    for trace in traces:
        refuse_frozen(trace, noise, model)
    _refuse_each((t.source, _wrong_alone(model, t, noise)) for t in traces)
    together = _wrong(model, traces, noise)
    if together is not None:
        raise together
    files = list(dict.fromkeys(trace.source for trace in traces))
    _refuse_each((file, mistaken(model, [t for t in traces if t.source == file], noise)) for file in files)
    if len(files) > 1 and (together := mistaken(model, traces, noise)) is not None:
        raise together
    return notes


def _refuse_each(found: Iterable[tuple[str, BadInputError | None]]) -> None:
    """Refuse the first mistake, with the files that have it, however right others beside them are."""
    wrong = {file: error for file, error in found if error is not None}
    for error in wrong.values():
        alike = [file for file, other in wrong.items() if _kind(other) == _kind(error)]
        raise BadInputError(error.what, where=", ".join(alike), fix=error.fix)


def _wrong_alone(model: Model, trace: Trace, noise: Array) -> BadInputError | None:
    """What does not go together in one recording; two speeds without any relation may be in another unit."""
    error = _wrong(model, [trace], noise)
    if error is None or _kind(error) != _UNRELATED:
        return error
    return mistaken(model, [trace], noise) or error


@dataclass(frozen=True)
class Examined:
    """Recordings made ready for fits, the noise of their channels per sample (3,), and notes on them."""

    traces: list[Trace]
    noise: Array
    notes: list[str]


def examine(
    model: Model, recordings: Sequence[Recording], beside: Sequence[Trace] = ()
) -> tuple[list[Trace], list[str]]:
    """The traces and notes of `examined`.

    Raises:
        BadInputError: like `examined`.
    """
    found = examined(model, recordings, beside)
    return found.traces, found.notes


def examined(model: Model, recordings: Sequence[Recording], beside: Sequence[Trace] = ()) -> Examined:
    """Recordings as they come from a file made ready for fits, and what `check` notes on them.

    Args:
        beside: others of the same channels: a coarse rounding shows better in many.

    Raises:
        BadInputError: like `check`, and where a recording is too short or too slowly sampled.
    """
    for recording in recordings:
        refuse_implausible(recording)
    comparable = [with_outputs_of(model, recording) for recording in recordings]
    pieces = [part for r in comparable for piece in unbroken(r, model.load_input) for part in excerpts(piece)]
    traces = [trace_of(part, load=None if is_regulated(model) else load_of(model, part)) for part in pieces]
    if not traces:
        return Examined([], np.full(3, np.nan), [])
    noise = usable_noise(noise_levels(traces))
    return Examined(traces, noise, check(model, traces, noise, beside))


def _kind(error: BadInputError) -> str:
    """What is wrong, without its numbers."""
    return error.what.split(":")[0]


def _wrong(model: Model, traces: list[Trace], noise: Array) -> BadInputError | None:
    """What does not go together in `traces`, seen together."""
    slow = slow_motion_of(model)
    if slow is None:
        return None
    ratio, inertia = slow.gear_ratio, slow.inertia_kg_m2
    pushes = {OUTPUTS[i]: pushes_of(traces, i, ratio, ratio / inertia) for i in (0, 1)}
    fine = [OUTPUTS[i] for i in (0, 1) if not any(coarse(t, i) for t in traces if t.has[i])]
    return _speeds(traces, ratio, noise, pushes) or refused_push(pushes, fine) or _shaft(traces, slow, noise)


def _speeds(
    traces: list[Trace], ratio: float, noise: Array, pushes: dict[str, list[Pair]]
) -> BadInputError | None:
    """Motor speed against wheel speed: sign, order of magnitude, ratio."""
    uneven, brisk, even, plain = Pair(), Pair(), Pair(), Pair()
    both = [t for t in traces if t.has[0] and t.has[1] and not (coarse(t, 0) or coarse(t, 1))]
    for t in both:
        wheel, motor = t.measured[:, 1], t.measured[:, 0] / ratio
        step = t.block * t.dt
        angles = [np.cumsum(v) * step for v in (wheel, motor)]
        for pair, degree in ((uneven, 1), (brisk, drift_degree(angles[0], step))):
            turns = np.column_stack([around(degree, angle) for angle in angles])
            pair.add(*turns[np.abs(turns).max(axis=1) > APART_RAD].T)
        plain.add(wheel - wheel.mean(), motor - motor.mean())
        mean = np.array([wheel.mean()]), np.array([motor.mean()])
        if max(abs(mean[0][0]), abs(mean[1][0])) > FAST_RAD_S:
            even.add(*mean)
    turned = [p for p in (uneven, even) if p.count]
    for column, other in ((0, 1), (1, 0)):
        sizes = [(p.sizes[1], p.sizes[0])[column] / (p.sizes[1], p.sizes[0])[other] for p in turned]
        by_torque = [p.correlation > RELATED for p in pushes[OUTPUTS[other]]]
        moves = bool(even.count) or (bool(by_torque) and all(by_torque))  # and does not only drift
        if moves and sizes and max(sizes) < DEAD_SHARE and all(_noise_alone(t, column, noise) for t in both):
            return _dead(OUTPUTS[column])
    seen = [*beyond_drift(uneven, brisk), *([even] if even.count else [])]
    if not seen:
        return None
    if all(p.correlation < INVERTED for p in seen) and plain.correlation < 0.0:
        return _inverted(pushes)
    if all(abs(p.correlation) < RELATED for p in (*seen, plain)):
        return BadInputError(_UNRELATED, fix="check that both are from one axle and synchronous")
    factors = [p.factor for p in seen]
    if even.count == 0 and max(uneven.sizes) < TURNED_RAD:
        return None
    if all(f > SPEED_RATIO[1] for f in factors) or all(f < SPEED_RATIO[0] for f in factors):
        return _wrong_ratio(factors[0], ratio)
    return None


def _inverted(pushes: dict[str, list[Pair]]) -> BadInputError:
    """Of two speeds that go against each other the one that goes against the torque."""
    channel = f"either {_MOTOR} or {_WHEEL}"
    if any(pushes.values()):
        channel = min((_MOTOR, _WHEEL), key=lambda c: min((p.correlation for p in pushes[c]), default=0.0))
    return BadInputError(f"{channel} looks inverted", fix="invert the sign of the channel")


def _wrong_ratio(factor: float, ratio: float) -> BadInputError:
    """`factor` is motor over wheel speed, over the model's gear ratio."""
    if SPEED_RATIO[0] < factor * ratio**2 < SPEED_RATIO[1]:
        return BadInputError(f"{_MOTOR} and {_WHEEL} look swapped", fix="exchange the two columns")
    for channel, expected in ((_MOTOR, _RPM), (_WHEEL, 1.0 / _RPM)):
        if abs(factor / expected - 1.0) < LIKE_RPM:
            return BadInputError(
                f"{channel} looks like rpm: motor over wheel speed is {factor * ratio:.3g}, "
                f"the model's gear ratio is {ratio:.3g}",
                fix="multiply it by 2π/60; or check that the model belongs to this axle",
            )
    return BadInputError(
        f"the gear ratio looks wrong: motor over wheel speed is {factor * ratio:.3g}, "
        f"the model has {ratio:.3g}",
        fix="check that the model belongs to this axle, and the units of the speeds",
    )


def _shaft(traces: list[Trace], slow: SlowMotion, noise: Array) -> BadInputError | None:
    """Shaft torque against motor torque at low frequency: sign and order of magnitude.

    What brakes the wheels passes the shafts only as far as it brakes the rotor, and what turns the rotor does
    not pass them. A torque that is limited swings less than asked for: then its mean is of the right size.
    """
    ratio, rotor = slow.gear_ratio, slow.rotor_kg_m2
    passed = rotor / (slow.inertia_kg_m2 - rotor)
    share = 1.0 - rotor / slow.inertia_kg_m2
    pair, even = Pair(), Pair()
    having = [t for t in traces if t.has[2]]
    for t in having:
        length = max(1, round(SLOW_S / t.dt))
        count = len(t.torque) // length
        if count >= 3:
            drive = t.torque * ratio + (0.0 if t.load is None else passed * t.load)
            torque = drive[: count * length].reshape(count, length).mean(axis=1)
            shaft = t.samples[: count * length, 2].reshape(count, length).mean(axis=1)
            pair.add(torque - torque.mean(), shaft - shaft.mean())
            if abs(torque.mean()) > np.std(torque):
                even.add(np.array([torque.mean()]), np.array([shaft.mean()]))
    if not pair.count or max(pair.sizes) < MOVES * noise[2]:
        return None
    alone = abs(pair.correlation) < RELATED and all(_noise_alone(t, 2, noise) for t in having)
    if alone and _moves(traces, noise):
        return _dead(_SHAFT)
    if pair.correlation < INVERTED and 1 / TOO_FAST < pair.factor < TOO_FAST:
        return BadInputError(f"{_SHAFT} looks inverted", fix="invert the sign of the channel")
    factors = [p.factor for p in (pair, even) if p.count]
    off = all(f < share / TORQUE_OFF for f in factors) or all(f > TORQUE_OFF for f in factors)
    if abs(pair.correlation) > RELATED and off:
        slope = pair.xy / max(pair.xx, 1e-30)
        return BadInputError(
            f"{_SHAFT} is {slope * ratio:.3g} times the motor torque at low frequency, the model has "
            f"{share * ratio:.3g}",
            fix="check the unit of the channel, and that it is on the wheel side of the gear",
        )
    return None


def _noise_alone(trace: Trace, column: int, noise: Array) -> bool:
    return bool(np.std(trace.samples[:, column]) < NOISE_ALONE * noise[column])


def _moves(traces: list[Trace], noise: Array) -> bool:
    """Whether any speed does more than read noise."""
    return any(np.std(t.measured[:, c]) > MOVES * noise[c] for t in traces for c in (0, 1) if t.has[c])


def _dead(channel: str) -> BadInputError:
    return BadInputError(
        f"{channel} looks dead: it shows only noise while the axle moves",
        fix="repair the channel, or omit it from the recordings",
    )
