"""Draws a case from a seed: plant, hidden effects, experiments, noise, and the model that is handed out."""

from __future__ import annotations

import zlib
from dataclasses import dataclass

import numpy as np

from hil.core.channels import OUTPUTS
from hil.core.model import Model, parameter_names
from tests.blind.experiments import SAMPLE_S, Experiment, holdout_set, in_closed_loop, main_set
from tests.blind.families import FAMILIES, RIGID, Draw, Hidden, Setting, fits
from tests.blind.later_families import LATER_FAMILIES, QUIET, later_fits
from tests.blind.outsiders import LATER_OUTSIDERS, OUTSIDERS, outsider_fits
from tests.blind.plant import Array, Truth
from tests.blind.sizing import Bench, Ruler, largest_share, likeness
from tests.blind.specs import SIZES, Spec

_TYPICAL = {
    "motor_inertia": 0.02,
    "gear_ratio": 8.5,
    "shaft_stiffness": 6000.0,
    "shaft_damping": 20.0,
    "wheel_inertia": 4.4,
    "tyre_stiffness": 5700.0,
    "tyre_damping": 350.0,
    "vehicle_inertia": 300.0,
    "viscous_drag": 0.002,
    "torque_delay": 0.008,
}
ALL_FAMILIES: dict[str, Draw] = FAMILIES | LATER_FAMILIES
_SPREAD = 0.25  # how far plants differ from the typical one
_CALIBRATION = 0.015  # how far a model is from its plant; files state 2 %
_CLOSED_LOOP_SHARE = 0.15
_DRAWS = 6
_MISSED = 1.5  # a share this many times too small or too large is drawn again
_ALIKE = 0.6  # |cos| above which a pair is not asked for
_NOT_TOGETHER = (
    {"dead_time", "actuator_lag"},
    {"torque_rate_limit", "actuator_lag"},
    {"torque_saturation", "actuator_lag"},
    {"torque_saturation", "torque_rate_limit"},
    {"coulomb_friction", "running_resistance"},
    {"viscous_drag", "running_resistance"},
    {"torque_deadband", "coulomb_friction"},
    {"mount_mode", "shaft_cubic_stiffness"},
    {"shaft_hysteresis", "backlash"},
    {"shaft_hysteresis", "shaft_cubic_stiffness"},
)


@dataclass(frozen=True)
class NoiseLevel:
    """White noise with a coloured share; standard deviations in the units of OUTPUTS."""

    deviations: Array
    share: float
    corner_hz: float


@dataclass(frozen=True)
class Case:
    """A drawn case. Only `model` and what `experiments` and `holdout` measure go to the diagnosis."""

    spec: Spec
    seed: int
    model: Model
    truth: Truth
    hidden: tuple[Hidden, ...]
    share: float
    experiments: tuple[Experiment, ...]
    holdout: tuple[Experiment, ...]
    noise: NoiseLevel
    channels: tuple[str, ...] = OUTPUTS


def draw_case(seed: int, spec: Spec, length: float = 1.0) -> Case:
    """The case that `seed` and `spec` name, always the same; recordings `length` times as long as usual."""
    rng = np.random.default_rng([seed, zlib.crc32(spec.key.encode())])
    kind = _kind(rng, spec)
    nominal = nominal_parameters(rng, kind)
    base = Truth(kind, {name: value * calibration_error(rng) for name, value in nominal.items()})
    scale = rng.uniform(0.8, 1.25)
    experiments, holdout = main_set(rng, scale, length), holdout_set(rng, scale, length)
    bench = Bench(base, experiments)
    deviation = np.std(np.concatenate(bench.plain), axis=0)
    noise = noise_level(rng, deviation, QUIET.get(spec.subject, 1.0))
    setting = Setting(kind, base.parameters, scale, dict(zip(OUTPUTS, deviation.tolist(), strict=True)))
    hidden, share = _hidden(rng, spec, bench, setting, noise)
    if spec.group == "mismatch":
        nominal, hidden, share = _mismatch(rng, bench, nominal, noise)
    if spec.group == "one_recording":
        experiments, hidden, share = _most_telling(rng, hidden[0], bench, noise, share)
    if rng.uniform() < _CLOSED_LOOP_SHARE:
        experiments = [in_closed_loop(e, rng) for e in experiments]
    for one in hidden:
        base = base.joined(Truth(kind, {}, one.laws, one.sensors))
    rounded = {name: float(f"{value:.4g}") for name, value in nominal.items()}
    return Case(
        spec, seed, Model(kind, rounded), base, hidden, share, tuple(experiments), tuple(holdout), noise
    )


def noise_level(rng: np.random.Generator, deviation: Array, quiet: float) -> NoiseLevel:
    """Noise of 0.5 to 2 % of the outputs' standard deviations, times `quiet`."""
    return NoiseLevel(
        deviation * np.exp(rng.uniform(np.log(0.005), np.log(0.02), 3)) * quiet,
        rng.uniform(0.0, 0.15),
        rng.uniform(2.0, 15.0),
    )


def calibration_error(rng: np.random.Generator) -> float:
    """Factor between a plant's parameter and what its model file says."""
    return 1.0 + rng.uniform(-_CALIBRATION, _CALIBRATION)


def _kind(rng: np.random.Generator, spec: Spec) -> str:
    kinds = ("three_inertia", "two_inertia", "rigid")
    draws = rng.choice(kinds, size=60, p=(0.55, 0.3, 0.15))
    check = outsider_fits if spec.group == "outside" else registered_fits
    if spec.subject in ALL_FAMILIES or spec.group == "outside":
        return str(next(kind for kind in draws if check(spec.subject, kind)))
    return str(draws[0])


def registered_fits(subject: str, kind: str) -> bool:
    """Whether an effect of the registry, or a form of one, can be hidden behind a model of `kind`."""
    return later_fits(subject, kind) if subject in LATER_FAMILIES else fits(subject, kind)


def nominal_parameters(rng: np.random.Generator, kind: str) -> dict[str, float]:
    """What a model file of `kind` says, to four figures."""
    nominal = {
        name: _TYPICAL[name] * float(np.exp(rng.uniform(-_SPREAD, _SPREAD))) for name in parameter_names(kind)
    }
    return {name: float(f"{value:.4g}") for name, value in nominal.items()}


def _hidden(
    rng: np.random.Generator,
    spec: Spec,
    bench: Bench,
    setting: Setting,
    noise: NoiseLevel,
) -> tuple[tuple[Hidden, ...], float]:
    if spec.group in ("none", "mismatch"):
        return (), 0.0
    if spec.group == "pair":
        return _pair(rng, spec, bench, setting, noise)
    return _sized(rng, spec, bench, setting, noise)


def _sized(
    rng: np.random.Generator,
    spec: Spec,
    bench: Bench,
    setting: Setting,
    noise: NoiseLevel,
) -> tuple[tuple[Hidden], float]:
    """The subject at the size that was asked for; drawn again when these outputs cannot show it."""
    outside = spec.group == "outside"
    draw = (OUTSIDERS | LATER_OUTSIDERS)[spec.subject] if outside else ALL_FAMILIES[spec.subject]
    registered = FAMILIES if spec.subject in OUTSIDERS else ALL_FAMILIES
    ruler = Ruler(bench, noise.deviations, own_parameter(spec.subject))
    wanted = share_of(SIZES[spec.size])
    best: tuple[float, Hidden, float] | None = None
    before: Hidden | None = None
    for _ in range(_DRAWS):
        family = draw(rng, setting)
        if family.of_size(1.0) == before:
            break  # nothing but the size is drawn
        before = family.of_size(1.0)
        size, share = ruler.size_for(family, wanted)
        hidden = family.of_size(size)
        left = share
        if outside and 1.0 / _MISSED < share / wanted < _MISSED:
            known = [
                registered[id](rng, setting) for id in registered if registered_fits(id, bench.base.kind)
            ]
            middles = [f.of_size(float(np.sqrt(f.smallest * f.largest))) for f in known]
            left = ruler.unexplained(ruler.residual(hidden), middles)
        missed = abs(np.log(max(left, 1e-9) / wanted))
        if best is None or missed < best[0]:
            best = (missed, hidden, left)
        if missed < np.log(_MISSED):
            break
    assert best is not None
    return (best[1],), best[2]


def share_of(ratio: float) -> float:
    """Share of an effect whose gap is `ratio` times the noise floor: they add by squares."""
    return float(np.sqrt(ratio**2 - 1.0))


def own_parameter(id: str) -> str:
    """The base parameter that an effect is a change of: a refit may not take it away."""
    return {"dead_time": "torque_delay", "viscous_drag": "viscous_drag"}.get(id, "")


def _pair(
    rng: np.random.Generator,
    spec: Spec,
    bench: Bench,
    setting: Setting,
    noise: NoiseLevel,
) -> tuple[tuple[Hidden, ...], float]:
    """Two effects, each large enough alone, whose traces differ."""
    ruler = Ruler(bench, noise.deviations)
    while True:
        first, second = (ALL_FAMILIES[id](rng, setting) for id in _pair_names(rng, spec, bench.base.kind))
        if first.id == second.id or {first.id, second.id} in _NOT_TOGETHER:
            continue
        hidden, traces = [], []
        for family in (first, second):
            of_one = ruler
            if own_parameter(family.id) in bench.base.parameters:
                of_one = Ruler(bench, noise.deviations, own_parameter(family.id))
            size, _ = of_one.size_for(family, share_of(SIZES[spec.size]))
            hidden.append(family.of_size(size))
            traces.append(of_one.residual(hidden[-1]))
        channels = [s.channel for h in hidden for s in h.sensors]
        if len(channels) == len(set(channels)) and likeness(*traces) < _ALIKE:
            return tuple(hidden), min(largest_share(t) for t in traces)


def _pair_names(rng: np.random.Generator, spec: Spec, kind: str) -> list[str]:
    """Two of the first effects, or the subject, which joined later, and any other."""
    names = [*RIGID] if kind == "rigid" else [id for id in FAMILIES if fits(id, kind)]
    if spec.subject not in LATER_FAMILIES:
        return [str(id) for id in rng.choice(names, 2, replace=False)]
    later = [id for id in LATER_FAMILIES if later_fits(id, kind) and id not in (spec.subject, *QUIET)]
    return [spec.subject, str(rng.choice([*names, *later]))]


def _mismatch(
    rng: np.random.Generator,
    bench: Bench,
    nominal: dict[str, float],
    noise: NoiseLevel,
) -> tuple[dict[str, float], tuple[Hidden, ...], float]:
    """One parameter of the model file is 3 to 10 % wrong, one that the outputs show."""
    base = bench.base
    names = [name for name in base.parameters if name not in ("torque_delay", "gear_ratio", "viscous_drag")]
    best: tuple[float, str, float] = (0.0, "", 0.0)
    for name in rng.permutation(names):
        factor = 1.0 + rng.choice([-1.0, 1.0]) * rng.uniform(0.03, 0.1)
        ruler = Ruler(bench, noise.deviations, str(name))
        wrong = base.with_parameter(str(name), base.parameters[str(name)] * factor)
        share = ruler.share_of_truth(wrong)
        if share > best[0]:
            best = (share, str(name), factor)
        if share > share_of(SIZES["edge"]):
            break
    share, name, factor = best
    values: dict[str, float | str] = {"parameter": name, "value": base.parameters[name]}
    return (
        nominal | {name: base.parameters[name] * factor},
        (Hidden("parameter_mismatch", {}, (), values),),
        share,
    )


def _most_telling(
    rng: np.random.Generator,
    hidden: Hidden,
    bench: Bench,
    noise: NoiseLevel,
    share: float,
) -> tuple[list[Experiment], tuple[Hidden, ...], float]:
    """One of the two recordings that show the effect best."""
    own = own_parameter(hidden.id)
    shares = [
        Ruler(bench.only(number), noise.deviations, own).share(hidden)
        for number in range(len(bench.experiments))
    ]
    order = np.argsort(shares)[::-1]
    chosen = int(order[0] if rng.uniform() < 0.7 else order[1])
    return [bench.experiments[chosen]], (hidden,), max(shares[chosen], 0.0) or share


def duration_s(case: Case) -> float:
    return sum(len(e.torque_nm) for e in case.experiments) * SAMPLE_S
