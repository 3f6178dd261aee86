"""Rows of the table of faults for values that are not measured any more, though their frames keep coming."""

from __future__ import annotations

from sim_backend.bench import DYNO_BUS
from tests.faults import injecting as I
from tests.faults.expected import EITHER, LIVE, PASSED, FaultRow, row

_FROZEN = "repeats bit for bit"
_UNDER_TORQUE = ("stepping",)
_LEFT, _RIGHT = (0x183, 0x283), (0x184, 0x284)  # TPDO 1 and 2

SENSORS: tuple[FaultRow, ...] = (
    row(
        "frozen-dynos",
        "both dynos' measured values repeat",
        lambda: I.Received(I.stuck(*_LEFT, *_RIGHT), DYNO_BUS),
        _FROZEN,
        phases=_UNDER_TORQUE,
        safe=EITHER,  # the statusword repeats too: whether the drive is off cannot be read
    ),
    row(
        "frozen-side",
        "one dyno's measured values repeat",
        lambda: I.Received(I.stuck(*_RIGHT), DYNO_BUS),
        _FROZEN,
        phases=_UNDER_TORQUE,
        safe=EITHER,  # the statusword repeats too: whether the drive is off cannot be read
    ),
    row(
        "frozen-status",
        "the RMCU's status repeats, its counter runs",
        lambda: I.Received(I.stuck_values()),
        _FROZEN,
        phases=_UNDER_TORQUE,
        safe=EITHER,  # its torque request is read from the same frame
    ),
    row(
        "flipped-status",
        "1 of 100 status frames has a flipped bit",
        lambda: I.Received(I.flipped_status(100)),
        code=PASSED,
        within_s=None,
        phases=_UNDER_TORQUE,
    ),
    row(
        "damaged",
        "1 of 50 of the RMCU's frames has flipped bits",
        lambda: I.Received(I.damaged(50)),
        code=PASSED,
        within_s=None,
        phases=LIVE[1:],
    ),
)
