"""Draws the cases of the groups that joined the set; see later_groups."""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hil.core.channels import OUTPUTS
from hil.core.model import Model
from tests.blind.cases import (
    ALL_FAMILIES,
    Case,
    NoiseLevel,
    calibration_error,
    noise_level,
    nominal_parameters,
    own_parameter,
    registered_fits,
    share_of,
)
from tests.blind.experiments import holdout_set, main_set
from tests.blind.families import Draw, Hidden, Setting
from tests.blind.later_families import QUIET
from tests.blind.later_groups import COUNTS
from tests.blind.loops import by_the_dyno, closed_by
from tests.blind.other_laws import OTHER_LAWS, other_law_fits
from tests.blind.plant import Array, Truth
from tests.blind.sensors import Sensor
from tests.blind.sizing import Bench, Ruler
from tests.blind.specs import SIZES, Spec

_DRAWS = 6
_MISSED = 1.5  # a share this many times too small or too large is drawn again
_TINY = 0.05  # share of an effect that is not worth a name: a gap of 1.001 times the noise
_OFF = (0.2, 0.8)  # how far a parameter of a far base is from its plant's
_KNOWN_WELL = ("gear_ratio",)  # teeth are counted


def draw_later_case(seed: int, spec: Spec, length: float = 1.0) -> Case:
    """The case that `seed` and `spec` name, always the same; recordings `length` times as long as usual."""
    rng = np.random.default_rng([seed, zlib.crc32(spec.key.encode())])
    subject, _, how = spec.subject.partition("@")
    kind = _kind(rng, subject)
    nominal = nominal_parameters(rng, kind)
    base = Truth(kind, {name: value * calibration_error(rng) for name, value in nominal.items()})
    scale = rng.uniform(0.8, 1.25)
    experiments, holdout = main_set(rng, scale, length), holdout_set(rng, scale, length)
    if spec.group == "load_side":
        experiments, holdout = by_the_dyno(experiments, rng), by_the_dyno(holdout, rng)
    bench = Bench(base, experiments)
    deviation = np.std(np.concatenate(bench.plain), axis=0)
    noise = noise_level(rng, deviation, QUIET.get(subject, 1.0))
    setting = Setting(kind, base.parameters, scale, dict(zip(OUTPUTS, deviation.tolist(), strict=True)))
    channels: tuple[str, ...] = OUTPUTS
    hidden: tuple[Hidden, ...] = ()
    share = 0.0
    if subject != "none":
        count = COUNTS.get(how, len(OUTPUTS)) if spec.group == "few_channels" else len(OUTPUTS)
        hidden, share, channels = _hidden(rng, spec, subject, count, bench, setting, noise)
    for one in hidden:
        base = base.joined(Truth(kind, {}, one.laws, one.sensors))
    if spec.group == "closed_loop":
        experiments, holdout = (closed_by(how, of, base, rng) for of in (experiments, holdout))
    if spec.group == "drift":
        base = base.joined(Truth(kind, {}, {}, (_drifting(rng, noise, share_of(SIZES[spec.size])),)))
    if spec.group == "far":
        nominal = {n: v if n in _KNOWN_WELL else base.parameters[n] * _far(rng) for n, v in nominal.items()}
    rounded = {name: float(f"{value:.4g}") for name, value in nominal.items()}
    return Case(
        spec,
        seed,
        Model(kind, rounded),
        base,
        hidden,
        share,
        tuple(experiments),
        tuple(holdout),
        noise,
        channels,
    )


def _far(rng: np.random.Generator) -> float:
    return float(1.0 + rng.choice([-1.0, 1.0]) * rng.uniform(*_OFF))


def _kind(rng: np.random.Generator, subject: str) -> str:
    draws = rng.choice(("three_inertia", "two_inertia", "rigid"), size=60, p=(0.55, 0.3, 0.15))
    if subject == "none":
        return str(draws[0])
    check = other_law_fits if subject in OTHER_LAWS else registered_fits
    return str(next(kind for kind in draws if check(subject, kind)))


def _hidden(
    rng: np.random.Generator,
    spec: Spec,
    subject: str,
    count: int,
    bench: Bench,
    setting: Setting,
    noise: NoiseLevel,
) -> tuple[tuple[Hidden], float, tuple[str, ...]]:
    """(the subject at its size, its share in the channels that are shown, those channels).

    Channels that do not show it are passed over, as far as there are others.
    """
    draw: Draw = (ALL_FAMILIES | OTHER_LAWS)[subject]
    wanted = _TINY if spec.group == "too_small" else share_of(SIZES[spec.size])
    best: tuple[float, Hidden, float, tuple[str, ...]] | None = None
    for _ in range(_DRAWS):
        family = draw(rng, setting)
        if spec.group == "too_small":
            family = replace(family, smallest=1e-4 * family.smallest)
        about = [s.channel for s in family.of_size(family.largest).sensors]
        channels = _shown(rng, count, about)
        deviations = np.where(np.isin(OUTPUTS, channels), noise.deviations, np.inf)
        # a gain of 0.7 is no small effect, though a gear ratio without bounds would explain it
        as_it_stands = spec.group == "too_small" and bool(about)
        ruler = Ruler(bench, deviations, own_parameter(subject), refit=not as_it_stands)
        size, share = ruler.size_for(family, wanted)
        missed = abs(np.log(max(share, 1e-9) / wanted))
        if best is None or missed < best[0]:
            best = (missed, family.of_size(size), share, channels)
        if missed < np.log(_MISSED):
            break
    assert best is not None
    return (best[1],), best[2], best[3]


def _shown(rng: np.random.Generator, count: int, about: Sequence[str]) -> tuple[str, ...]:
    """`count` of the outputs, the motor speed most often; those that the effect is about among them."""
    if count == len(OUTPUTS):
        return OUTPUTS
    others = [name for name in OUTPUTS if name not in about]
    weights = np.array([3.0 if name == OUTPUTS[0] else 1.0 for name in others])
    more = rng.choice(others, count - len(about), replace=False, p=weights / weights.sum())
    return tuple(name for name in OUTPUTS if name in (*about, *more))


def _drifting(rng: np.random.Generator, noise: NoiseLevel, share: float) -> Sensor:
    """A channel whose reading swings slowly, `share` times the noise in rms, with nothing else wrong."""
    number = int(rng.integers(len(OUTPUTS)))
    deviation: Array = noise.deviations
    return Sensor(
        OUTPUTS[number],
        drift=float(np.sqrt(2.0) * share * deviation[number]),
        drift_period_s=rng.uniform(25.0, 120.0),
        drift_phase_rad=rng.uniform(-np.pi, np.pi),
    )
