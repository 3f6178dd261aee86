"""The table of faults."""

from __future__ import annotations

import signal
from collections.abc import Callable
from functools import partial
from typing import Any

from sim_backend.bench import DYNO_BUS, RMCU_BUS, Fault
from tests.faults import injecting as I
from tests.faults.expected import (
    ALL,
    ARMED,
    EITHER,
    GOES_ON,
    INTERRUPTED,
    LIVE,
    PASSED,
    UNSAFE,
    Expected,
    FaultRow,
    row,
)
from tests.faults.further_rows import FURTHER
from tests.faults.sensor_rows import SENSORS
from tests.faults.stage import Injection
from tests.faults.third_party import Oil

SILENT, NO_ANSWER = (
    "stopped coming",
    "no answer|no heartbeat|sends no|heartbeat lost|did not change the state",
)
RMCU_FAULT = "the RMCU went to fault"
KEPT_S = 0.3  # a disk is heard of when it is written to


def tolerated(id_: str, title: str, make: Callable[[], Injection], **keys: Any) -> FaultRow:
    """What ends no run."""
    return row(id_, title, make, code=PASSED, within_s=None, **keys)


def in_call(call: str, **keys: Any) -> FaultRow:
    """A mistake in another package's device."""

    def make() -> Injection:
        return I.Code(I.in_device(call), I.raises)

    return row(f"device-{call}", f"mistake in `{call}` of a device", make, "LookupError", device=True, **keys)


def nan_reading(failing: Callable[[], None]) -> None:
    """Count each reading that is none."""

    def read() -> float:
        before = I.counted()
        failing()
        return float("nan") if I.counted() > before else 330.0

    Oil.reading = staticmethod(read)


def signalled(number: signal.Signals) -> Injection:
    """Somebody sends the process a signal."""
    return I.Does(I.signalled(number))


def requests(change: Callable[[int, bytes], Any], **keys: Any) -> Injection:
    return I.Sent(RMCU_BUS, lambda i: i == I.REQUEST.id, change, **keys)


_OF_DEVICES = (
    row("rmcu-silent", "RMCU without power", lambda: I.Breaks(Fault.RMCU_SILENT), SILENT, safe=UNSAFE),
    row(
        "rmcu-deaf",
        "RMCU hears nothing, but sends",
        lambda: I.Breaks(Fault.RMCU_DEAF),
        "RMCU",
        # No torque is asked for any more: nothing that could be noticed, nothing that could go wrong
        other=dict.fromkeys(("prompting", "analysing", "ramping down"), GOES_ON)
        | {"stepping": Expected(says="fault: timeout", safe=UNSAFE)},
    ),
    row(
        "rmcu-slow",
        "RMCU's frames come 0.3 s late",
        lambda: I.Late(RMCU_BUS, 0.3),
        SILENT,
        safe=EITHER,
        other={"pre-flight": Expected(says=f"RMCU|{SILENT}", safe=EITHER)},
    ),
    row("rmcu-reset", "RMCU boots", lambda: I.Breaks(Fault.RMCU_RESET), SILENT),
    row(
        "rmcu-crc",
        "wrong checksums in the RMCU's frames",
        lambda: I.Received(I.wrong_crc),
        "checksum",
        safe=UNSAFE,
    ),
    row(
        "rmcu-flipped",
        "the RMCU's state is changed on the way",
        lambda: I.Received(I.flipped),
        "checksum",
        safe=UNSAFE,
    ),
    row(
        "rmcu-counter",
        "RMCU's counter stands still",
        lambda: I.Received(I.stuck_counter()),
        "counter",
        safe=UNSAFE,
    ),
    row("rmcu-short", "RMCU's frames are too short", lambda: I.Received(I.short), SILENT, safe=UNSAFE),
    row(
        "rmcu-status",
        "RMCU's status frame alone stops",
        lambda: I.Received(I.without(I.STATUS.id)),
        SILENT,
        safe=UNSAFE,
    ),
    row(
        "rmcu-control",
        "RMCU's control frame alone stops",
        lambda: I.Received(I.without(I.CONTROL.id)),
        SILENT,
        safe=UNSAFE,
    ),
    row(
        "dyno-silent",
        "left dyno without power",
        lambda: I.Breaks(Fault.DYNO_SILENT),
        f"{SILENT}|{NO_ANSWER}",
        safe=UNSAFE,
    ),
    row(
        "dyno-deaf",
        "dynos hear nothing, but send",
        lambda: I.Breaks(Fault.DYNO_DEAF),
        "EMCY 0x8130|no answer",
        within_s=0.3,
    ),
    row(
        "dyno-slow",
        "dynos' frames come 0.3 s late",
        lambda: I.Late(DYNO_BUS, 0.3),
        f"{SILENT}|{NO_ANSWER}",
        safe=EITHER,
    ),
    row(
        "dyno-reset",
        "left dyno boots",
        lambda: I.Breaks(Fault.DYNO_RESET),
        f"{SILENT}|reads back",
        safe=UNSAFE,
        other={"pre-flight": GOES_ON, "arming": Expected(says="reads back", safe=EITHER)},
    ),  # it had not been configured yet
    row(
        "dyno-fault", "left drive goes to fault", lambda: I.Breaks(Fault.DYNO_FAULT), "EMCY 0x2320|in 'fault'"
    ),
    row(
        "dyno-runaway",
        "drives run away",
        lambda: I.Breaks(Fault.DYNO_RUNAWAY),
        "limit tripped",
        safe=UNSAFE,
        within_s=0.4,
        phases=LIVE[2:],
    ),
    row(
        "dyno-aborts",
        "dynos refuse what is written",
        lambda: I.Received(I.aborts, DYNO_BUS),
        "refused",
        phases=LIVE[:2],
    ),
    row(
        "dyno-answers",
        "another value is read back",
        lambda: I.Received(I.other_answer, DYNO_BUS),
        "reads back",
        phases=LIVE[:2],
    ),
    row("emcy", "EMCY of a dyno", lambda: I.Does(I.emcy(0x4210)), "EMCY 0x4210"),
    row(
        "heartbeat",
        "heartbeat of the left dyno alone stops",
        lambda: I.Received(I.without(0x703), DYNO_BUS),
        "heartbeat lost",
        within_s=0.45,
    ),
)
_OF_WIRES = (
    row(
        "rmcu-bus-off",
        "adapter off the RMCU's bus",
        lambda: I.Refused(RMCU_BUS),
        "interface is down|stopped",
        safe=UNSAFE,
    ),
    row(
        "dyno-bus-off",
        "adapter off the dynos' bus",
        lambda: I.Refused(DYNO_BUS),
        "interface is down|stopped",
        safe=UNSAFE,
        other={"arming": Expected(says="interface is down", safe=EITHER)},
    ),
    tolerated("lost", "1 of 20 frames of the RMCU lost", lambda: I.Received(I.every(20))),
    tolerated("loss", "1 of 100 frames lost, on all buses, both ways", lambda: I.Lossy(100)),
    row(
        "lost-all",
        "every frame of the RMCU lost for 0.3 s",
        lambda: I.Received(I.every(1), for_s=0.3),
        SILENT,
    ),
    tolerated("doubled", "every frame of the RMCU twice", lambda: I.Received(I.doubled)),
    tolerated("reordered", "neighbours change places for 0.2 s", lambda: I.Received(I.shuffled, for_s=0.2)),
    tolerated("delayed", "frames 30 ms late for 0.2 s", lambda: I.Late(RMCU_BUS, 0.03, for_s=0.2)),
    tolerated(
        "request-lost",
        "one torque request lost",
        lambda: requests(lambda i, d: [], most=1),
        phases=("arming", "stepping"),
    ),
    row(
        "requests-lost",
        "torque requests lost for 0.1 s",
        lambda: requests(lambda i, d: [], for_s=0.1),
        RMCU_FAULT,
        phases=("stepping",),
    ),
    row(
        "requests-crc",
        "torque requests damaged for 0.1 s",
        lambda: requests(lambda i, d: [(i, bytes([d[0] ^ 16]) + d[1:])], for_s=0.1),
        RMCU_FAULT,
        phases=("stepping",),
    ),
    row(
        "heartbeats-lost",
        "the host's heartbeats lost",
        lambda: I.Sent(DYNO_BUS, lambda i: i == 0x77F, lambda i, d: []),
        "EMCY 0x8130",
        within_s=0.35,
        phases=ARMED,
    ),
    tolerated("garbage", "garbage on the RMCU's bus", lambda: I.Floods(I.garbage)),
    row(
        "sdo-garbage",
        "answers and heartbeats that no one sent",
        lambda: I.Floods(I.sdo_garbage, DYNO_BUS),
        "",
    ),
    row(
        "stamps-later",
        "the adapter's clock jumps by an hour",
        lambda: I.Received(I.stamped(3600.0)),
        "jumped",
    ),
    row(
        "stamps-earlier",
        "the adapter's clock jumps back an hour",
        lambda: I.Received(I.stamped(-3600.0)),
        "jumped",
    ),
)
_OF_SENSORS = (
    row(
        "nan",
        "a sensor gives NaN",
        lambda: I.Code(nan_reading, lambda stage: None),
        "oil_temperature_k",
        device=True,
    ),
    row(
        "offset",
        "a torque sensor reads 2 kN m too much",
        lambda: I.Does(I.sensor("shaft_torque_left_nm", offset=2000.0)),
        "shaft_torque_left_nm",
    ),
    row(
        "stuck",
        "a wheel's speed is stuck",
        lambda: I.Received(I.stuck(0x183), DYNO_BUS),
        "the wheels turn at|repeats bit for bit",
        within_s=None,  # until its speed should have changed no one can know
    ),
    row(
        "no-torque",
        "torque does not follow",
        lambda: I.Received(I.no_torque),
        within_s=None,  # found when the run is judged
        phases=("stepping",),
    ),
)
_OF_THE_COMPUTER = (
    row(
        "stall",
        "the loop stands still for 1 s",
        lambda: I.Does(I.stalls(1.0)),
        "the bench loop was delayed",
        other=dict.fromkeys(LIVE[:2], GOES_ON),
    ),
    row(
        "short-stall",
        "the loop stands still for 60 ms",
        lambda: I.Does(I.stalls(0.06)),
        RMCU_FAULT,
        phases=("stepping",),
    ),
    row(
        "disk-full", "no file may grow", lambda: I.Does(I.disk_full), "recording", phases=ALL, within_s=KEPT_S
    ),
    row(
        "disk-fails",
        "the disk takes nothing",
        lambda: I.Does(I.disk_fails),
        "recording",
        phases=ALL,
        within_s=KEPT_S,
    ),
    *(
        row(
            number.name.lower(),
            number.name,
            partial(signalled, number),
            "stopped|interrupted",
            code=INTERRUPTED,
            phases=ALL,
        )
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    ),
)
_OF_CODE = (
    in_call("beat"),
    in_call("come_up", phases=("pre-flight",)),
    in_call("troubles", phases=ARMED),
    # It says that it is safe all the same
    in_call("make_safe", phases=ARMED, other=dict.fromkeys(ARMED, GOES_ON)),
    in_call("is_safe", phases=ALL, safe=UNSAFE, within_s=None),  # no one asks before the end
    in_call("close", phases=ALL, other=dict.fromkeys(ALL, GOES_ON)),  # the bench is safe, the result written
    row(
        "step",
        "mistake in a plan's step",
        lambda: I.Code(I.in_step, I.raises),
        "LookupError",
        phases=LIVE[2:],
        within_s=None,  # it is made in the next step, when the torque of this one is over
    ),
    row(
        "criterion",
        "mistake in a criterion",
        lambda: I.Code(I.in_metric, I.raises),
        within_s=None,
        phases=ALL,
    ),
    row(
        "recorder",
        "mistake in the recorder",
        lambda: I.Code(I.in_recorder, I.raises),
        "LookupError",
        phases=ALL,
    ),
    row(
        "report",
        "mistake in a report",
        lambda: I.Code(I.in_reports, I.raises),
        "LookupError",
        phases=("writing",),
    ),
)
FAULTS: tuple[FaultRow, ...] = (
    *_OF_DEVICES,
    *_OF_WIRES,
    *_OF_SENSORS,
    *FURTHER,
    *SENSORS,
    *_OF_THE_COMPUTER,
    *_OF_CODE,
)
