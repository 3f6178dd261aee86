"""Whether the channels of a segment were measured: one sentence for each that was not."""

from __future__ import annotations

from collections.abc import Iterable

from hil.core.recording import Recording
from hil.core.result import Segment
from test_plans.evidence._dynamics import (
    INERTIA_IN_WORDS,
    LAG_IN_WORDS,
    inertia_in_words,
    lag_in_words,
)
from test_plans.evidence._relations import RELATIONS, contradictions, proven_channels
from test_plans.evidence._repetition import SENSORS, WITNESSES, frozen_channels

#: Channels that are computed from both sides, and what they are computed from.
_SIDES = {
    "shaft_torque_nm": ("shaft_torque_left_nm", "shaft_torque_right_nm"),
    "wheel_speed_rad_s": ("wheel_speed_left_rad_s", "wheel_speed_right_rad_s"),
}


def _proofs() -> dict[str, tuple[str, ...]]:
    found: dict[str, list[str]] = {}
    for name in SENSORS:
        witness = f", or while {WITNESSES[name]} moves" if WITNESSES[name] else ""
        found.setdefault(name, []).append(f"does not repeat bit for bit beyond its noise{witness}")
    for one in RELATIONS:
        bounds = f"within {one.within[0]:g} to {one.within[1]:g} times"
        for name in one.channels:
            found.setdefault(name, []).append(f"{one.law}, {bounds}")
    for name in ("shaft_torque_nm", "motor_torque_nm"):
        found[name].append(LAG_IN_WORDS)
    for name in ("shaft_torque_nm", "wheel_speed_rad_s"):
        found[name].append(INERTIA_IN_WORDS)
    for whole, sides in _SIDES.items():
        found[whole] += [f"both sides: {text}" for text in dict.fromkeys(t for s in sides for t in found[s])]
    return {name: tuple(dict.fromkeys(texts)) for name, texts in found.items()}


#: What proves that a channel was measured, in words.
PROOFS = _proofs()


def objections(recording: Recording, segment: Segment) -> dict[str, str]:
    """Channels that were not measured in a segment, each with the reason; empty where all were.

    A relation in which two channels contradict each other counts against both: no one knows which of them
    is wrong.
    """
    found = {name: str(frozen) for name, frozen in frozen_channels(recording, segment).items()}
    found = {
        **inertia_in_words(recording, segment),
        **lag_in_words(recording, segment),
        **contradictions(recording, segment),
        **found,
    }
    for whole, sides in _SIDES.items():
        for side in sides:
            if side in found:
                found[whole] = found[side]
    return found


def unproven(recording: Recording, segment: Segment, channels: Iterable[str]) -> tuple[str, ...]:
    """Those of some channels that sensors give, and that nothing in a segment was held against."""
    proven = proven_channels(recording, segment)
    return tuple(name for name in channels if name in SENSORS and name in recording and name not in proven)
