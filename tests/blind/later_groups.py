"""Groups that joined the set: far bases, few channels, loops, others' laws, loads, tiny effects, drift."""

from __future__ import annotations

from tests.blind.families import FAMILIES
from tests.blind.later_families import LATER_FAMILIES
from tests.blind.loops import LOOPS
from tests.blind.other_laws import OTHER_LAWS

LATER_GROUPS = ("far", "few_channels", "closed_loop", "other_laws", "too_small", "drift", "load_side")

#: How many channels a case of `few_channels` shows.
COUNTS = {"one": 1, "two": 2}

_NOT_FAR = ("dead_time",)  # a wrong dead time of the base is just that
# a tyre that shows so little is too stiff for the plant's steps
_NEVER_TINY = ("tyre_compliance",)
#: A gain of the only channel is an inertia.
_CANNOT_BE_SEEN = (("sensor_gain", "one"),)
#: What a load at the wheels shows beside the motor's torque.
_BY_LOAD = (
    "backlash",
    "shaft_cubic_stiffness",
    "coulomb_friction",
    "running_resistance",
    "sensor_gain",
    "channel_skew",
)
_LOOPED = (
    "backlash", "coulomb_friction", "shaft_hysteresis", "shaft_cubic_stiffness", "torque_saturation",
    "actuator_lag", "dead_time", "mount_mode", "sensor_gain", "wheel_order_disturbance",
)  # fmt: skip


def later_specs() -> list[tuple[str, str, str, int]]:
    """(group, subject, size, turn) of every case; in `few_channels` and `closed_loop` the subject ends in
    `@` and how many channels, or which loop."""
    every = [*FAMILIES, *LATER_FAMILIES]
    specs = [("far", id, "clear", 0) for id in every if id not in _NOT_FAR]
    specs += [("far", "none", "none", turn) for turn in range(12)]
    specs += [
        ("few_channels", f"{id}@{many}", "clear", 0)
        for id in FAMILIES
        for many in COUNTS
        if (id, many) not in _CANNOT_BE_SEEN
    ]
    specs += [("closed_loop", f"{id}@{loop}", "clear", 0) for id in _LOOPED for loop in LOOPS]
    specs += [("closed_loop", f"none@{loop}", "none", turn) for loop in LOOPS for turn in range(2)]
    specs += [
        ("other_laws", id, size, turn)
        for id in OTHER_LAWS
        for size in ("large", "clear")
        for turn in range(2)
    ]
    specs += [("too_small", id, "tiny", 0) for id in every if id not in _NEVER_TINY]
    specs += [("drift", "none", size, turn) for size in ("clear", "large") for turn in range(6)]
    specs += [("load_side", id, "clear", 0) for id in _BY_LOAD]
    specs += [("load_side", "none", "none", turn) for turn in range(6)]
    return specs
