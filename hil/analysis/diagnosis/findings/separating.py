"""The test that tells two effects apart: plans simulated with both, the one that differs most is written.

What is simulated is what the plan itself will play, sample by sample.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import yaml

from hil.analysis.diagnosis.findings.consequences import apart, played
from hil.analysis.diagnosis.thresholds import (
    DURATION_S,
    FAST_KM_H,
    SETTLE_S,
    SHARES,
    SLOW_KM_H,
    TELLS,
    WHEEL_RADIUS_M,
    WORTH_A_PLAN,
)
from hil.analysis.missing_effects import Series
from hil.core.channels import OUTPUTS, unit_of
from hil.core.errors.wording import multiple, quantity
from hil.core.model import EffectUse, Model
from test_plans import Plan, plan_from_text
from test_plans.steps import SAMPLE_TIME_S, Excitation, HoldSpeed

Array = npt.NDArray[np.float64]
Steps = list[dict[str, dict[str, Any]]]

_WORDS = {
    "chirp_large": "a chirp of large amplitude",
    "chirp_small": "a chirp of small amplitude",
    "chirp_biased": "a chirp around a bias that never reverses",
    "chirp_standstill": "a chirp around standstill",
    "stairs": "torque stairs through zero from standstill",
    "coast": "a coast-down",
}


@dataclass(frozen=True)
class _Test:
    """A plan, what it plays (N m, every SAMPLE_TIME_S), and the wheel speed in rad/s it begins at."""

    name: str
    plan: Plan
    text: str
    torque: Array
    speed: float


class Most(NamedTuple):
    """Largest torque request in N m, wheel speed in rad/s and shaft torque in N m that a test may reach."""

    torque_nm: float
    speed_rad_s: float
    shaft_torque_nm: float


NO_TEST = "no test is predicted"
"""So begins what is said in place of one."""


def separating_plan(
    one: Model, other: Model, noise: Array, most: Most, names: tuple[str, str]
) -> tuple[str, str]:
    """Text in words, and a plan file, of the test at which two models differ most against the noise.

    Args:
        noise: standard deviation of each output per sample, shape (3,); NaN for one that is not measured.
        most: what either model may reach.
        names: ids of the two effects.

    Returns:
        the plan is empty where no test would tell the two apart, or where the models take their load from
        recordings and so cannot predict one; the text says so.
    """
    if one.load_input:
        return f"{NO_TEST}: the models do not hold what makes {one.load_input}", ""
    candidates = []
    for name in _WORDS:
        for share in SHARES:
            test = _test(name, share * most.torque_nm, names)
            a, b = _outputs(test, (one, other))
            if all(_within(o, most) for o in (a, b)):
                candidates.append((_rms(((a - b) / noise)[:, np.isfinite(noise)]), test))
                break
    levels, chosen = _best(one, other, candidates, noise)
    if chosen is None:
        return "no test of ours stays within the recordings' speed and shaft torque", ""
    whole = float(np.linalg.norm(levels)) * np.sqrt(len(chosen.torque))
    if whole < TELLS:
        shown = f"{whole:.3g} noise levels of difference over its whole length, and {TELLS:g} are needed"
        return f"no test of ours tells them apart: the best shows {shown}", ""
    peak = float(np.max(np.abs(chosen.torque)))
    return f"{_WORDS[chosen.name]}, up to {peak:.3g} N m: {_difference(levels, noise)}", chosen.text


def worth_a_plan(confidence: float, most: Most) -> bool:
    """Whether a rival is likely enough; without torque in the recordings no one knows what a test may ask."""
    return confidence > WORTH_A_PLAN and most.torque_nm > 0.0


def most_of(traces: Sequence[Series], simulated: Sequence[Array]) -> Most:
    """What recordings reached, so that it is within the bench's limits: as measured, or else as simulated.

    Args:
        simulated: channels of each recording, n x 3.
    """
    reached = [
        np.max(np.abs(np.where(one.has, one.samples, shown)), axis=0)
        for one, shown in zip(traces, simulated, strict=True)
    ]
    _, wheel, shaft = np.max(reached, axis=0).tolist()
    return Most(max(float(np.max(np.abs(one.torque))) for one in traces), wheel, shaft)


def plan_file(use: EffectUse) -> str:
    """Name of the plan that separates an effect from what is given back."""
    about = use.values.get("channel", use.values.get("parameter", ""))
    return "_".join(part for part in ("separate", use.id, str(about)) if part) + ".yaml"


def _difference(levels: Array, noise: Array) -> str:
    """The difference in the channel that shows it best, in its unit and beside its noise.

    Args:
        levels: rms of the difference in each output, in its noise; 0 where it is not measured.
    """
    column = int(np.argmax(levels))
    channel, level = OUTPUTS[column], float(levels[column])
    rms = quantity(level * float(noise[column]), unit_of(channel))
    return f"the two differ by {rms} rms in {channel}, {multiple(level)} its noise in a sample"


def _best(
    one: Model, other: Model, candidates: list[tuple[float, _Test]], noise: Array
) -> tuple[Array, _Test | None]:
    """The test that tells most beyond what numbers make up for, and how much: noise levels rms, by output.

    Args:
        candidates: tests with what they tell before numbers have made up for anything: never less.
    """
    measured = np.isfinite(noise)
    level, levels, chosen = 0.0, np.zeros(len(noise)), None
    for most, test in sorted(candidates, key=lambda c: -c[0]):
        if most <= level:
            break
        errors = apart(one, other, partial(_measured, test, measured), noise[measured])
        left = _rms(errors)
        if left > level:
            level, chosen = left, test
            levels[measured] = np.sqrt(np.mean(np.nan_to_num(errors) ** 2, axis=0))
    return levels, chosen


def _measured(test: _Test, measured: npt.NDArray[np.bool_], models: Sequence[Model]) -> Array:
    return _outputs(test, models)[:, :, measured]


def _outputs(test: _Test, models: Sequence[Model]) -> Array:
    return played(models, test.torque, SAMPLE_TIME_S, test.speed)


def _rms(errors: Array) -> float:
    return float(np.sqrt(np.mean(np.sum(np.nan_to_num(errors) ** 2, axis=1))))


def _within(outputs: Array, most: Most) -> bool:
    reached = np.max(np.abs(outputs[:, 1:]), axis=0)  # NaN is not within
    return bool(reached[0] <= most.speed_rad_s and reached[1] <= most.shaft_torque_nm)


def _test(name: str, torque: float, names: tuple[str, str]) -> _Test:
    """A candidate with its largest torque."""
    a, b = names
    table = {
        "name": f"separate_{a}_{b}",
        "title": f"Test that tells {a} from {b}",
        "steps": _steps(name, torque),
        "finally": [{"ramp_down": {"duration_s": 4}}],
    }
    text = (
        f"# Tells {a} from {b}: carry it out with 'hil run', then give its recording.mcap\n"
        "# to 'hil diagnose' together with the others.\n" + str(yaml.safe_dump(table, sort_keys=False))
    )
    plan = plan_from_text(text, "separating plan", Path())
    speeds = [s.speed_km_h / 3.6 / WHEEL_RADIUS_M for s in plan.steps if isinstance(s, HoldSpeed)]
    torques = [s.samples(SAMPLE_TIME_S, 0) for s in plan.steps if isinstance(s, Excitation)]
    return _Test(name, plan, text, np.concatenate(torques), speeds[-1] if speeds else 0.0)


def _steps(name: str, torque: float) -> Steps:
    """The steps of a plan; torque in N m. The dynos simulate the vehicle while torque is played."""
    if name == "stairs":
        levels = [round(s * torque, 2) for s in (0, 0.5, -0.5, 0.1, -0.1, 1, -1, 0)]
        hold = DURATION_S / len(levels)
        return [_played("stairs", segment=name, levels_nm=levels, hold_s=hold)]
    if name == "coast":  # the step 'coast' would leave the dynos holding their speed
        levels = [0.0, 0.0]
        return [_held(FAST_KM_H), _played("stairs", segment=name, levels_nm=levels, hold_s=DURATION_S / 2)]
    amplitude, bias, speed = {
        "chirp_large": (1.0, 0.0, SLOW_KM_H),
        "chirp_small": (0.2, 0.0, SLOW_KM_H),
        "chirp_biased": (0.35, 0.6, SLOW_KM_H / 2),
        "chirp_standstill": (1.0, 0.0, 0.0),
    }[name]
    chirp = _played(
        "chirp",
        segment=name,
        from_hz=0.1,
        to_hz=30,
        duration_s=DURATION_S,
        amplitude_nm=round(amplitude * torque, 3),
        bias_nm=round(bias * torque, 3),
    )
    return [_held(speed), chirp] if speed else [chirp]


def _held(speed_km_h: float) -> dict[str, dict[str, Any]]:
    return {"hold_speed": {"speed_km_h": speed_km_h, "duration_s": SETTLE_S}}


def _played(kind: str, **values: Any) -> dict[str, dict[str, Any]]:
    return {kind: {**values, "quantity": "motor_torque"}}
