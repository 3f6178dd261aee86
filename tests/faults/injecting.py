"""Every fault, and where it is put in: the one place for each, and each counts what it really changed."""

from __future__ import annotations

import contextlib
import errno
import importlib
import os
import resource
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import can
import numpy as np

from drivers import read_rmcu
from hil.core.can.frames import EXTENDED, FrameBlock, crc8_many, empty_block, frames, joined
from hil.core.can.signals import Payloads
from sim_backend.bench import RMCU_BUS, Fault, SensorFault
from tests.benches_for_tests import SIM
from tests.faults.stage import Injection, Stage
from tests.faults.third_party import Mark, Oil, Rows

RMCU = read_rmcu(SIM.rmcu.dbc)
REQUEST, STATUS, CONTROL, REPLY = (
    RMCU.layouts[f"RMCU_{name}"] for name in ("Request", "Status", "Control", "ParameterReply")
)
_VALUES_LEFT, _SDO_ANSWERS, _EMCY_LEFT, _HEARTBEATS = 0x183, (0x583, 0x584), 0x083, range(0x701, 0x705)

_ROOM = 60_000  # bytes: result.json and messages


@dataclass
class Breaks(Injection):
    """A device of the stand-in fails."""

    fault: Fault

    def begin(self, stage: Stage) -> None:
        stage.world.fail(self.fault)
        stage.count()


@dataclass
class Does(Injection):
    """Something is done once, to the nodes or the plant."""

    work: Callable[[Stage], None]

    def begin(self, stage: Stage) -> None:
        self.work(stage)
        stage.count()


@dataclass
class Drifts(Injection):
    """Sensors read more and more, in their unit per second."""

    channels: tuple[str, ...]
    per_s: float

    def to_hosts(self, stage: Stage, bus: str, block: FrameBlock) -> FrameBlock:
        del bus
        assert stage.injected_s is not None
        fault = SensorFault(offset=self.per_s * (stage.now_s - stage.injected_s))
        for channel in self.channels:
            stage.world.spoil(channel, fault)
        stage.count()
        return block


@dataclass
class Received(Injection):
    """What hosts receive of one bus is changed, for a time."""

    change: Callable[[FrameBlock], FrameBlock]
    bus: str = RMCU_BUS
    for_s: float = np.inf

    def to_hosts(self, stage: Stage, bus: str, block: FrameBlock) -> FrameBlock:
        assert stage.injected_s is not None
        if bus != self.bus or stage.now_s > stage.injected_s + self.for_s or not len(block):
            return block
        changed = self.change(block.copy())
        if len(changed) != len(block) or np.any(changed != block):
            stage.count()
        return changed


@dataclass
class Late(Injection):
    """Frames of one bus come later than they were sent."""

    bus: str
    by_s: float
    for_s: float = np.inf
    _waiting: list[tuple[float, FrameBlock]] = field(default_factory=list)

    def to_hosts(self, stage: Stage, bus: str, block: FrameBlock) -> FrameBlock:
        if bus != self.bus:
            return block
        assert stage.injected_s is not None
        held = stage.now_s <= stage.injected_s + self.for_s
        if len(block):
            self._waiting.append((stage.now_s + self.by_s * held, block))
            stage.count(held)
        due = []
        while self._waiting and self._waiting[0][0] <= stage.now_s:
            found = self._waiting.pop(0)[1].copy()
            found["time_s"] = np.maximum(found["time_s"], stage.now_s - 0.002)  # stamped as it comes
            due.append(found)
        return joined(due) if due else empty_block()


@dataclass
class Sent(Injection):
    """Frames of hosts are changed on their way to the nodes, for a time or a number of them."""

    bus: str
    which: Callable[[int], bool]
    change: Callable[[int, bytes], Iterable[tuple[int, bytes]]]
    for_s: float = np.inf
    most: float = np.inf

    def to_nodes(self, stage: Stage, bus: str, frame_id: int, data: bytes) -> Iterable[tuple[int, bytes]]:
        assert stage.injected_s is not None
        over = stage.now_s > stage.injected_s + self.for_s or stage.counted >= self.most
        if bus != self.bus or over or not self.which(frame_id):
            return [(frame_id, data)]
        stage.count()
        return self.change(frame_id, data)


@dataclass
class Lossy(Injection):
    """One of so many frames is lost, at random, on every bus and in both directions."""

    count: int
    _random: np.random.Generator = field(default_factory=lambda: np.random.default_rng(11))

    def to_hosts(self, stage: Stage, bus: str, block: FrameBlock) -> FrameBlock:
        kept = block[self._random.integers(0, self.count, len(block)) > 0]
        stage.count(len(kept) != len(block))
        return kept

    def to_nodes(self, stage: Stage, bus: str, frame_id: int, data: bytes) -> Iterable[tuple[int, bytes]]:
        lost = not self._random.integers(0, self.count)
        stage.count(lost)
        return [] if lost else [(frame_id, data)]


@dataclass
class Refused(Injection):
    """The adapter has left the bus: it takes and gives nothing."""

    bus: str

    def to_nodes(self, stage: Stage, bus: str, frame_id: int, data: bytes) -> Iterable[tuple[int, bytes]]:
        if bus != self.bus:
            return [(frame_id, data)]
        stage.count()
        raise can.CanOperationError("Network is down", errno.ENETDOWN)

    def to_hosts(self, stage: Stage, bus: str, block: FrameBlock) -> FrameBlock:
        if bus != self.bus:
            return block
        stage.count()
        return empty_block()


@dataclass
class Floods(Injection):
    """Frames that no device of the bench sends, or not like this, among those that come."""

    made: Callable[[np.random.Generator, float], FrameBlock]
    bus: str = RMCU_BUS
    _random: np.random.Generator = field(default_factory=lambda: np.random.default_rng(7))

    def to_hosts(self, stage: Stage, bus: str, block: FrameBlock) -> FrameBlock:
        if bus != self.bus:
            return block
        stage.count()
        return joined([block, self.made(self._random, stage.now_s)])


@dataclass
class Code(Injection):
    """A call into code of another package, or a part of ours, fails from now on."""

    plug_in: Callable[[Callable[[], None]], None]
    failure: Callable[[Stage], None]

    def plug(self, stage: Stage) -> None:
        def call() -> None:
            if stage.injected_s is not None:
                stage.count()
                self.failure(stage)

        self.plug_in(call)


def counted() -> int:
    """How often the fault of this run has been injected."""
    return Stage.current.counted


# --- what is done ---


def raises(stage: Stage) -> None:
    raise LookupError("no one thought of this")


def stalls(seconds: float) -> Callable[[Stage], None]:
    """The loop that holds the bench stands still: nothing is looked at, nothing sent."""

    def work(stage: Stage) -> None:
        stage.world.sleep_until(stage.now_s + seconds)

    return work


def in_device(call: str) -> Callable[[Callable[[], None]], None]:
    return lambda failing: Oil.faults.__setitem__(call, failing)


def in_step(failing: Callable[[], None]) -> None:
    Mark.fault = staticmethod(failing)


def in_metric(failing: Callable[[], None]) -> None:
    Rows.fault = staticmethod(failing)


def in_recorder(failing: Callable[[], None]) -> None:
    from hil.engine.run.recorder import Recorder

    before = Recorder.take_frames

    def take_frames(self: Recorder, bus: str, block: FrameBlock) -> None:
        failing()
        before(self, bus, block)

    Recorder.take_frames = take_frames  # type: ignore[method-assign]


def in_reports(failing: Callable[[], None]) -> None:
    command: Any = importlib.import_module("hil.app.run")

    def write_documents(*arguments: object) -> object:
        failing()
        return {}

    command.write_documents = write_documents


def signalled(number: int) -> Callable[[Stage], None]:
    return lambda stage: os.kill(os.getpid(), number)


def disk_full(stage: Stage) -> None:
    """No file may become larger than the recording is now, or than what is written beside it."""
    largest = max(_ROOM, *(os.fstat(int(handle)).st_size for handle in _of_the_recording()))
    resource.setrlimit(resource.RLIMIT_FSIZE, (largest, resource.getrlimit(resource.RLIMIT_FSIZE)[1]))


def _of_the_recording() -> list[str]:
    """Names of this process's handles of the recording."""
    found = []
    for handle in Path("/proc/self/fd").iterdir():
        with contextlib.suppress(OSError):
            if handle.readlink().name == "recording.mcap":
                found.append(handle.name)
    return found


def disk_fails(stage: Stage) -> None:
    """The recording's own file takes nothing any more."""
    for name in _of_the_recording():
        read_only = os.open(f"/proc/self/fd/{name}", os.O_RDONLY)
        os.dup2(read_only, int(name))
        os.close(read_only)


def emcy(code: int) -> Callable[[Stage], None]:
    return lambda stage: stage.world.dynos[0].tell(code)


def sensor(channel: str, **fault: float) -> Callable[[Stage], None]:
    return lambda stage: stage.world.spoil(channel, SensorFault(**fault))


# --- what becomes of frames ---


def without(*numbers: int) -> Callable[[FrameBlock], FrameBlock]:
    return lambda block: block[~np.isin(block["id"], numbers)]


def every(count: int, seed: int = 3) -> Callable[[FrameBlock], FrameBlock]:
    """One of so many frames is lost, at random."""
    random = np.random.default_rng(seed)
    return lambda block: block[random.integers(0, count, len(block)) > 0]


def damaged(count: int, seed: int = 5) -> Callable[[FrameBlock], FrameBlock]:
    """In one of so many frames bits are changed at random, whatever the frame."""
    random = np.random.default_rng(seed)

    def change(block: FrameBlock) -> FrameBlock:
        place = random.integers(0, count, len(block)) == 0
        block["data"][place] ^= random.integers(1, 1 << 63, int(place.sum()), dtype=np.uint64)
        return block

    return change


def doubled(block: FrameBlock) -> FrameBlock:
    return np.repeat(block, 2)


def shuffled(block: FrameBlock) -> FrameBlock:
    """Neighbours change places, stamps stay in order."""
    order = np.arange(len(block))
    for first in range(0, len(order) - 1, 2):
        order[first : first + 2] = first + 1, first
    mixed = block[order]
    mixed["time_s"] = block["time_s"]
    return mixed


def wrong_crc(block: FrameBlock) -> FrameBlock:
    block["data"][block["id"] == CONTROL.id] ^= np.uint64(0xFF << 56)
    return block


def flipped(block: FrameBlock) -> FrameBlock:
    """Bits are changed on the way, under a checksum that is the old one's."""
    block["data"][block["id"] == CONTROL.id] ^= np.uint64(0x5)
    return block


def _checked(payloads: Payloads) -> Payloads:
    """The same under the checksum that its RMCU would give it."""
    payloads = payloads & np.uint64((1 << 56) - 1)
    return payloads | crc8_many(CONTROL.id, payloads).astype(np.uint64) << np.uint64(56)


_VALUES = np.uint64((1 << 56) - 1)


def stuck_counter() -> Callable[[FrameBlock], FrameBlock]:
    signal_ = CONTROL.signals["Counter"]
    mask = np.uint64(((1 << signal_.length) - 1) << signal_.shift)
    kept: list[np.uint64] = []

    def change(block: FrameBlock) -> FrameBlock:
        place = block["id"] == CONTROL.id
        if place.any():
            kept[:] = kept or [block["data"][place][0] & mask]
            block["data"][place] = _checked((block["data"][place] & ~mask) | kept[0])
        return block

    return change


def stuck(*frame_ids: int) -> Callable[[FrameBlock], FrameBlock]:
    """Their payloads do not change any more, bit for bit."""
    kept: dict[int, np.uint64] = {}

    def change(block: FrameBlock) -> FrameBlock:
        for frame_id in frame_ids:
            place = block["id"] == frame_id
            if place.any():
                block["data"][place] = kept.setdefault(frame_id, block["data"][place][0])
        return block

    return change


def stuck_values() -> Callable[[FrameBlock], FrameBlock]:
    """The RMCU's status keeps its values, under a counter that runs and a checksum that is right."""
    kept: list[np.uint64] = []
    counter = np.uint64(0xF)

    def change(block: FrameBlock) -> FrameBlock:
        place = block["id"] == STATUS.id
        if place.any():
            kept[:] = kept or [block["data"][place][0] & ~counter & _VALUES]
            payloads = block["data"][place] & counter | kept[0]
            block["data"][place] = payloads | crc8_many(STATUS.id, payloads) << np.uint64(56)
        return block

    return change


def flipped_status(every: int) -> Callable[[FrameBlock], FrameBlock]:
    """A bit of one in so many status frames is flipped, at random."""
    random = np.random.default_rng(7)

    def change(block: FrameBlock) -> FrameBlock:
        place = (block["id"] == STATUS.id) & (random.integers(0, every, len(block)) == 0)
        bits = random.integers(4, 56, len(block)).astype(np.uint64)
        block["data"][place] ^= np.uint64(1) << bits[place]
        return block

    return change


def no_torque(block: FrameBlock) -> FrameBlock:
    """The inverter gives none, whatever it is asked for."""
    torque = STATUS.signals["MotorTorque"]
    mask = np.uint64(((1 << torque.length) - 1) << torque.shift)
    place = block["id"] == STATUS.id
    zero = np.uint64(int(STATUS.encode(MotorTorque=0.0)[0])) & mask
    payloads = ((block["data"][place] & ~mask) | zero) & _VALUES
    block["data"][place] = payloads | crc8_many(STATUS.id, payloads) << np.uint64(56)
    return block


def short(block: FrameBlock) -> FrameBlock:
    place = np.isin(block["id"], (STATUS.id, CONTROL.id))
    block["length"][place] = 2
    block["data"][place] &= np.uint64(0xFFFF)
    return block


def stamped(by_s: float) -> Callable[[FrameBlock], FrameBlock]:
    def change(block: FrameBlock) -> FrameBlock:
        block["time_s"] += by_s
        return block

    return change


def aborts(block: FrameBlock) -> FrameBlock:
    """The node refuses what it is asked by SDO (CiA 301: abort, general error)."""
    place = np.isin(block["id"], _SDO_ANSWERS)
    block["data"][place] = (
        (block["data"][place] & np.uint64(0xFFFFFF00)) | np.uint64(0x80) | np.uint64(0x08000000 << 32)
    )
    return block


def other_answer(block: FrameBlock) -> FrameBlock:
    """What is read back is not what was written."""
    place = np.isin(block["id"], _SDO_ANSWERS) & (block["data"] & np.uint64(0xE0) == np.uint64(0x40))
    block["data"][place] ^= np.uint64(1 << 32)
    return block


def garbage(random: np.random.Generator, now_s: float) -> FrameBlock:
    """Frames of other identifiers, other lengths, extended ones of ours."""
    numbers = np.where(random.random(20) < 0.5, random.integers(0x300, 0x500, 20), STATUS.id)
    made = [
        frames(int(number), int(random.integers(0, 1 << 62)), int(random.integers(0, 9)), now_s,
               flags=EXTENDED if number == STATUS.id else 0)
        for number in numbers
    ]  # fmt: skip
    return joined(made)


def sdo_garbage(random: np.random.Generator, now_s: float) -> FrameBlock:
    """Answers that no one asked for, of every kind and length."""
    made = [
        frames(int(random.choice([*_SDO_ANSWERS, _EMCY_LEFT + 0x600, 0x000, 0x703])),
               int(random.integers(0, 1 << 62)), int(random.integers(0, 9)), now_s)
        for _ in range(3)
    ]  # fmt: skip
    return joined(made)
