"""What a diagnosis may not claim: gaps against the true noise, intervals against the true numbers."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from tests.blind.casefiles import Answer

_LEAST_SHRUNK = 0.5  # of a gap's excess over the noise, for a name to have explained it
_SHOWS = 1.1  # gap before over the true noise from which a channel counts as one with a gap
_TWICE = 2.0  # error over the true noise that nobody may call explained
_NORMAL_95 = 1.959964

#: Effects whose law the plant and the registry write with the same numbers. Dry friction, hysteresis and free
#: play are others' laws there.
SAME_NUMBERS = (
    "dead_time", "actuator_lag", "torque_saturation", "torque_rate_limit", "torque_deadband", "torque_gain",
    "shaft_cubic_stiffness", "viscous_drag", "mount_mode", "tyre_compliance", "wheel_order_disturbance",
    "motor_order_ripple", "running_resistance", "sensor_gain", "sensor_offset", "channel_skew", "sensor_lag",
)  # fmt: skip


def judged_gaps(answer: Answer, diagnosis: Mapping[str, Any]) -> tuple[list[str], list[str]]:
    """(channels whose gap a `named` shrank by less than half, those that a `none` leaves far over the noise).

    Gaps of the recordings that were fitted, noise as it was added.
    """
    gaps = diagnosis.get("gap") or {}
    verdict = diagnosis.get("verdict")
    ratios = {
        name: (float(gaps[name]["before"]) / noise, float(gaps[name]["after"]) / noise)
        for name, noise in answer.noise.items()
        if name in gaps and noise > 0.0
    }
    if verdict == "named":
        kept = 1.0 - _LEAST_SHRUNK
        return [n for n, (b, a) in ratios.items() if b > _SHOWS and _excess(a) > kept * _excess(b)], []
    if verdict == "none":
        return [], [name for name, (_, after) in ratios.items() if after > _TWICE]
    return [], []


def _excess(ratio: float) -> float:
    """What is in a gap beside the noise, in units of it: they add by squares."""
    return math.sqrt(max(ratio**2 - 1.0, 0.0))


def standard_errors_off(
    answer: Answer, entries: Sequence[Mapping[str, Any]], named: Sequence[str]
) -> dict[str, float]:
    """How far each number with a standard error is from the true one, in standard errors; by `name.number`.

    Only of effects whose law has the same numbers in the plant and in the registry.
    """
    off = {}
    for id, values in answer.effects:
        label = label_of(id, values)
        if id not in SAME_NUMBERS or label not in named:
            continue
        entry = entries[named.index(label)]
        if not is_itself(entry, label):
            continue
        for name, error in (entry.get("standard_error") or {}).items():
            true = values.get(name)
            if isinstance(true, str) or true is None or not error:
                continue
            miss = float(entry["parameters"][name]) - float(true)
            if name == "phase_rad":
                miss = (miss + math.pi) % (2.0 * math.pi) - math.pi
            off[f"{label}.{name}"] = miss / float(error)
    return off


def is_itself(entry: Mapping[str, Any], label: str) -> bool:
    """Whether an effect is given by that name; by another one of its class it has other numbers."""
    return label_of(str(entry["id"]), entry.get("parameters", {})) == label


def label_of(id: str, values: Mapping[str, Any]) -> str:
    """The name, with the channel or parameter that it is about: another channel is another answer."""
    about = values.get("channel") or values.get("parameter")
    return f"{id}({about})" if about else id


def holds(standard_errors: float) -> bool:
    """Whether a 95 % interval holds a number that is so many standard errors away."""
    return abs(standard_errors) <= _NORMAL_95
