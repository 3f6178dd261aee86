"""A look at the dynamometers that changes nothing: who is there, what it is, what it says of itself."""

from __future__ import annotations

import contextlib
from collections.abc import Collection, Sequence

from drivers.device import Examined, Finding
from drivers.dyno._node import ENABLED, FAULT, STATE_MASK, DynoNode
from drivers.loop import BusLoop
from drivers.wire import Wire
from hil.core.can.frames import SENT_BY_HOST, FrameBlock, standard
from hil.core.errors import DeviceError
from hil.core.errors.wording import printable

_HIGHEST_NODE = 127
_ANSWERS_WITHIN_S = 0.3
_HEARTBEATS_WITHIN_S = 1.2
_READ_DEVICE_TYPE = bytes((0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0))  # SDO upload of 0x1000
_BETWEEN_REQUESTS_S = 0.001
_DRIVE_PROFILE = 402
_SIDES = ("left", "right")
_READINGS = 10
OTHER_PDOS = "give the EDS or DCF of this device, or load the parameters of that file into it"
_MEASURED = {"Wheel speed": "wheel_speed_{}_rad_s", "Shaft torque": "shaft_torque_{}_nm"}
# Index, subindex, what it is and how it is shown (CiA 301): texts, and the identity object
_IDENTITY = (
    (0x1008, 0, "name", ""),
    (0x1009, 0, "hardware", ""),
    (0x100A, 0, "software", ""),
    (0x1018, 1, "vendor", "#010x"),
    (0x1018, 2, "product", "#010x"),
    (0x1018, 3, "revision", "#010x"),
    (0x1018, 4, "serial", "d"),
)


def examine(
    loop: BusLoop, wire: Wire, used: Sequence[DynoNode], idle: Sequence[DynoNode], *, ask: bool
) -> Examined:
    """Every node of the bench file; if one is missing, also who else is on the bus."""
    found = Examined()
    missing = []
    for node in (*used, *idle):
        beats = loop.clock.now_s() - node.last_heartbeat_s < _HEARTBEATS_WITHIN_S
        there = _look_at(node, found, beats=beats, drives=node in used, ask=ask)
        found.answers |= there and node in used
        if not there:
            missing.append(node)
        elif ask and node in used:
            found.readings |= _measured(node, _SIDES[used.index(node)])
    if missing:
        strangers = _strangers(loop, wire, {node.id for node in (*used, *idle)}, ask=ask)
        for node in missing:
            found.findings.append(_missing(node, wire.name, strangers, used=node in used))
    return found


def _measured(node: DynoNode, side: str) -> dict[str, float]:
    """Means of what its sensors read, by channel; before a run has started them they send nothing."""
    readings = {}
    with contextlib.suppress(DeviceError):
        for name, channel in _MEASURED.items():
            values = [node.measured(name) for _ in range(_READINGS)]
            known = [value for value in values if value is not None]
            if known:
                readings[channel.format(side)] = sum(known) / len(known)
    return readings


def identify(nodes: Sequence[DynoNode]) -> dict[str, str]:
    """What each node says that it is; of one that does not answer nothing."""
    found = {}
    for node in nodes:
        with contextlib.suppress(DeviceError):
            for index, subindex, name, shown in _IDENTITY:
                value = node.read(index, subindex)
                if value not in (None, ""):
                    found[f"{node.name}: {name}"] = printable(format(value, shown), 80)
    return found


def _look_at(node: DynoNode, found: Examined, *, beats: bool, drives: bool, ask: bool) -> bool:
    """Add what a node says of itself; whether it is there."""
    where = f"dyno '{node.name}' (node {node.id})"
    try:
        device_type = node.read(0x1000) if ask else None
    except DeviceError:
        device_type = None
        if not beats:
            return False
        fix = "check that the adapter can send (not listen-only), and that no other node has the same id"
        found.findings.append(
            Finding("fault", "sends heartbeats, but does not answer when it is read", where, fix)
        )
    if not beats and device_type is None:
        return False
    if not beats:
        fix = "give it a heartbeat time (object 0x1017, producer heartbeat), 100 ms for instance"
        found.findings.append(Finding("fault", "answers, but sends no heartbeat", where, fix))
    else:
        found.facts[f"{node.name}: NMT"] = node.nmt_state
    if device_type is not None:
        _read(node, found, device_type, where, drives=drives)
    if device_type is not None and drives:
        _compare_pdos(node, found, where)
    for text in node.emergencies:
        found.findings.append(Finding("fault", text, where, "look the code up in the dyno's manual"))
    return True


def _compare_pdos(node: DynoNode, found: Examined, where: str) -> None:
    """Add where the device's PDOs are not those of its EDS."""
    with contextlib.suppress(DeviceError):
        for text in node.differences():
            found.findings.append(Finding("fault", text, where, OTHER_PDOS))


def _read(node: DynoNode, found: Examined, device_type: int, where: str, *, drives: bool) -> None:
    if drives and device_type & 0xFFFF != _DRIVE_PROFILE:
        fix = "check the node ids in the bench file"
        what = f"is not a CiA 402 drive: its device type is 0x{device_type:08X}"
        found.findings.append(Finding("fault", what, where, fix))
        return
    register = node.read(0x1001)
    if register:
        fix = "look at the dyno controller's fault list"
        found.findings.append(Finding("fault", f"its error register reads 0x{register:02X}", where, fix))
    status = node.read(0x6041)
    if status is None:
        return
    found.facts[f"{node.name}: drive"] = node.state_of(status)
    if drives and status & STATE_MASK == FAULT:
        fix = "look at the dyno controller's fault list; a run tries to reset it once"
        found.findings.append(Finding("fault", "the drive is in fault", where, fix))
    if status & STATE_MASK == ENABLED:
        fix = "find out why it was switched on; switch it off before anyone approaches"
        found.findings.append(Finding("fault", "the drive is enabled, but no run is active", where, fix))


def _missing(node: DynoNode, bus: str, strangers: Collection[int], *, used: bool) -> Finding:
    others = ", ".join(map(str, sorted(strangers)))
    if strangers:
        answer = f"node {others} answers" if len(strangers) == 1 else f"nodes {others} answer"
        fix = f"{answer} and stands in no bench file: is one of them {node.name}? Correct its node id"
        fix = fix.replace("is one of them", "is it") if len(strangers) == 1 else fix
        fix = fix.replace("stands", "stand") if len(strangers) > 1 else fix
    else:
        fix = "switch the dyno controller on; check the bus, its bit rate and the node id in the bench file"
    need = "" if used else "; runs go on without it"
    return Finding("fault", f"{node.name} (node {node.id}) is missing{need}", f"bus '{bus}'", fix)


def _strangers(loop: BusLoop, wire: Wire, known: Collection[int], *, ask: bool) -> set[int]:
    """Nodes that no one expects: by their heartbeats, and by asking every other id for its device type."""
    heard: set[int] = set()

    def take(bus: str, block: FrameBlock) -> None:
        if bus == wire.name:
            frames = standard(block)
            ids = frames["id"][frames["flags"] & SENT_BY_HOST == 0]
            for base in (0x580, 0x700):
                heard.update(int(i) - base for i in ids[(ids > base) & (ids <= base + _HIGHEST_NODE)])

    loop.on_block(take)
    if ask:
        for node in range(1, _HIGHEST_NODE + 1):
            if node not in known:
                wire.send(0x600 + node, _READ_DEVICE_TYPE)
                loop.run_for(_BETWEEN_REQUESTS_S)
        loop.wait_for(lambda: False, _ANSWERS_WITHIN_S)
    loop.wait_for(lambda: False, _HEARTBEATS_WITHIN_S)
    return heard - set(known)
