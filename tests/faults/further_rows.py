"""Rows of the table of faults for the panel and for the monitor of the RMCU's memory."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from sim_backend.bench import RAM_BUS
from tests.faults import further_devices as F
from tests.faults import injecting as I
from tests.faults.expected import BENCH, GOES_ON, LIVE, PASSED, Expected, FaultRow, row
from tests.faults.stage import Injection

_MISSED = "the panel has sent nothing|no answer to"
#: A panel is asked twice a second, and missed after 0.6 s; lost samples are counted over a second.
_SLOW: dict[str, Any] = {"within_s": 1.3}


def panel(id_: str, title: str, make: Callable[[], Injection], says: str = "", **keys: Any) -> FaultRow:
    return row(f"panel-{id_}", title, make, says, **({"beside": "panel"} | keys))


def xcp(id_: str, title: str, change: Callable[[Any], Any], says: str = "", **keys: Any) -> FaultRow:
    return row(f"xcp-{id_}", title, lambda: I.Received(change, RAM_BUS), says, beside="ram", **keys)


FURTHER: tuple[FaultRow, ...] = (
    panel("silent", "the panel says nothing", lambda: F.PanelSays(F.nothing_said), _MISSED, **_SLOW),
    panel("noise", "noise in place of the panel", lambda: F.PanelSays(F.only_noise), _MISSED, **_SLOW),
    panel("half", "the panel's telegrams end half-way", lambda: F.PanelSays(F.half), _MISSED, **_SLOW),
    panel("echo", "the panel's line gives an echo only", lambda: F.PanelSays(F.echo), _MISSED, **_SLOW),
    panel(
        "garbage",
        "noise, echoes and halves among the panel's answers",
        lambda: F.PanelSays(F.among_garbage),
        code=PASSED,
        within_s=None,
    ),
    panel("away", "the adapter of the panel's line is pulled out", F.LineAway, _MISSED, **_SLOW),
    panel(
        "back",
        "it is pulled out and put in again after 0.2 s",
        lambda: F.LineAway(0.2),
        beside="patient panel",
        code=PASSED,
        within_s=None,
    ),
    panel(
        "busy",
        "the panel is busy for ever",
        lambda: F.PanelSays(F.BUSY_FOR_EVER),
        code=PASSED,
        within_s=None,
        other={"pre-flight": Expected(BENCH, "is busy for more than 3 s")},
    ),
    panel(
        "errors",
        "the panel answers everything with an error",
        lambda: F.PanelSays(F.ERRORS),
        code=PASSED,
        within_s=None,
        other={"pre-flight": Expected(BENCH, "does not know it")},
    ),
    panel("alarm", "an alarm at the panel", lambda: F.PanelIs(F.alarm), "alarm", **_SLOW),
    panel(
        "local", "somebody takes the panel to local", lambda: F.PanelIs(F.local), "local", **_SLOW
    ),
    xcp("silent", "the RMCU's memory is silent", F.nothing, "has stopped coming|no answer to CONNECT"),
    xcp("deaf", "it measures, but answers nothing", F.without_answers, "no answer to", phases=LIVE[:1]),
    xcp("zeros", "its answers are all zeros", F.zeroed, "bytes|cannot|invalid|no longer|lists", **_SLOW),
    xcp("errors", "it answers everything with an error", F.refused, "the slave fails", **_SLOW),
    xcp("cut", "its samples are a byte too short", F.cut, "has stopped coming|no complete sample"),
    xcp("counter", "its time stamps stand still", F.same_stamp, "time stamps of its samples stand still"),
    xcp("lost", "1 of 200 packets of samples lost", F.one_of(200), code=PASSED, within_s=None),
    xcp("lost-many", "1 of 5 packets of samples lost", F.one_of(5), "are lost", **_SLOW),
    xcp("overload", "it is overloaded, and says so", F.overloaded(), "overloaded", **_SLOW),
    row(
        "xcp-bus-off",
        "adapter off its bus",
        lambda: I.Refused(RAM_BUS),
        "interface is down|stopped",
        beside="ram",
        within_s=1.3,
    ),
    row(
        "xcp-reset",
        "its XCP starts anew",
        lambda: I.Does(lambda stage: stage.world.reset_xcp()),
        "has stopped coming",
        beside="ram",
        other={"pre-flight": GOES_ON},
    ),
    row("xcp-garbage", "garbage on its bus", lambda: I.Floods(I.garbage, RAM_BUS), code=PASSED, within_s=None,
        beside="ram"),
)  # fmt: skip
