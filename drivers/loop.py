"""The one loop that every driver waits in: it keeps heartbeats going and hands out what comes."""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Iterable, Iterator
from functools import partial
from typing import Protocol

import numpy as np
import numpy.typing as npt

from drivers.wire import Wire
from hil.core.can.frames import ERROR_FRAME, EXTENDED, SENT_BY_HOST, FrameBlock
from hil.core.channels import TICK_S
from hil.core.errors import InterruptError
from hil.core.runtime.clock import Clock
from hil.core.runtime.compiled import compiled

_DRAIN_EVERY = 10
_GIVEN_UP_TICKS = 10  # who is later than this goes on from where it is
_PART_S = 0.25e-3  # a part of long work that begins closer to a tick than this would hold it up
_STANDARD_IDS = 2048
_OTHERS = SENT_BY_HOST | EXTENDED | ERROR_FRAME

FrameCallback = Callable[[int, bytes, float], None]
BlockCallback = Callable[[str, FrameBlock], None]


class Port(Protocol):
    """A wire of another kind than CAN: a serial line, a socket."""

    def drain(self) -> bytes:
        """Every byte that came since the last call; never waits."""
        ...


class BusLoop:
    """Steps through time in 1 ms ticks on the thread of its caller.

    - `every`: duties such as heartbeats; they run in every step, whoever waits.
    - `on_frame`: callbacks for seldom frames (SDO, heartbeat, EMCY, parameter replies).
    - `on_block`: callbacks for everything on CAN, in blocks of at most 10 ms.
    - `serve`: callbacks for what comes on other wires, at most 10 ms old.
    - `on_drained`: callbacks for when every wire has been looked at.
    - `stop_requested`: set by a signal handler; the next step raises InterruptError, unless `shielded`.
    - `stop_reason`: what that error says.
    """

    def __init__(self, clock: Clock, wires: list[Wire]) -> None:
        self.clock = clock
        self.wires = wires
        self.stop_requested = False
        self.stop_reason = "stopped by the operator"
        self.shielded = False
        self.tick_s = clock.now_s()  # when the present tick was meant
        self._anchor_s, self._since_anchor = clock.now_s(), 0  # a sum of ticks would drift
        self._ticks = self._drained_at = 0
        self._sending: _Sending | None = None
        self._timed: list[_Duty] = []
        self._duties: list[_Duty] = []
        self._next_duty_s = np.inf
        self._callbacks: dict[str, dict[int, FrameCallback]] = {wire.name: {} for wire in wires}
        self._wanted = {wire.name: np.zeros(_STANDARD_IDS, bool) for wire in wires}
        self._block_callbacks: list[BlockCallback] = []
        self._served: list[Callable[[], None]] = []
        self._drained: list[Callable[[], None]] = []

    def every(
        self,
        period_s: float,
        duty: Callable[[], None],
        done: Callable[[float], None] | None = None,
    ) -> None:
        """Call `duty` every `period_s` of the clock, from now on; then `done` with the time it was meant.

        One with `done` is timed: it comes before those without, and `keep_up` does it too.
        """
        made = _Duty(period_s, self.clock.now_s(), duty, done)
        (self._duties if done is None else self._timed).append(made)
        self._next_duty_s = -np.inf

    def on_frame(self, wire: Wire, frame_id: int, callback: FrameCallback) -> None:
        """Call `callback(id, data, time_s)` for each received frame with this identifier."""
        self._callbacks[wire.name][frame_id] = callback
        self._wanted[wire.name][frame_id] = True

    def on_block(self, callback: BlockCallback) -> None:
        """Call `callback(bus, block)` for everything sent and received."""
        self._block_callbacks.append(callback)

    def serve(self, port: Port, take: Callable[[bytes, float], None]) -> None:
        """Call `take(data, time_s)` with what comes on `port`, in whatever pieces it comes."""

        def look() -> None:
            data = port.drain()
            if data:
                take(data, self.clock.now_s())

        self._served.append(look)

    def on_drained(self, callback: Callable[[], None]) -> None:
        """Call `callback()` each time that every wire and port has been looked at."""
        self._drained.append(callback)

    def step(self) -> None:
        """Wait for the next tick; do what is due, first of all what `each_tick` sends.

        Raises:
            InterruptError: the operator asked to stop.
            BenchError: a bus failed.
        """
        self._pass(1)

    def resume(self) -> None:
        """Count ticks from now if some have passed unserved: what comes next is not to catch up with them."""
        now_s = self.clock.now_s()
        if now_s - self.tick_s > TICK_S:
            self._anchor_s, self._since_anchor = now_s, 0
            self.tick_s = now_s

    def run_for(self, duration_s: float, until: Callable[[], bool] = lambda: False) -> bool:
        """Step for a while; false if `until` held before it was over."""
        left = round(duration_s / TICK_S)
        while left:
            if until():
                return False
            ticks = min(self._undisturbed(), left)
            self._pass(ticks)
            left -= ticks
        return True

    def each_tick(
        self,
        count: int,
        send: Callable[[int], None],
        ahead: Callable[[int, npt.NDArray[np.float64]], bool],
    ) -> Generator[int, None, None]:
        """Call `send(k)` first thing in each of `count` ticks; yields how many have passed.

        In virtual time `ahead(k, times_s)` may take those from `k` on up to the next look at the buses at
        once, each with the time of its tick; it says whether it does. In wall-clock time work that takes
        longer than a tick lets `keep_up` be called on the way. Close it if it is left early.
        """
        if not self.clock.virtual:
            yield from self._as_time_comes(count, send)
            return
        passed = 0
        while passed < count:
            ticks = min(self._undisturbed(), count - passed)
            if not ahead(passed, self._next_ticks(ticks)):
                ticks = 1
                send(passed)
            self._pass(ticks)
            passed += ticks
            yield passed

    def keep_up(self) -> None:
        """Between parts of long work: send what `each_tick` has due, and do the timed duties that are.

        A tick that is so near that the next part would hold it up is waited for.
        """
        if self._sending is not None:
            next_s = self._anchor_s + (self._since_anchor + 1) * TICK_S
            if 0.0 < next_s - self.clock.now_s() < _PART_S:
                self.clock.sleep_until(next_s)
            late_s = self.clock.now_s() - next_s
            if 0.0 <= late_s < _GIVEN_UP_TICKS * TICK_S:
                for _ in range(1 + int(late_s / TICK_S)):
                    self._since_anchor += 1
                    self._ticks += 1
                    self.tick_s = self._anchor_s + self._since_anchor * TICK_S
                    self._sending.next()
        if self._timed:
            now_s = self.clock.now_s()
            for duty in self._timed:
                duty.run_if_due(now_s - 0.5 * TICK_S, self.tick_s)

    def _as_time_comes(self, count: int, send: Callable[[int], None]) -> Iterator[int]:
        self.resume()
        sending = self._sending = _Sending(count, send)
        try:
            sending.next()
            while sending.passed < count:
                self.step()
                yield sending.passed
        finally:
            self._sending = None

    def wait_for(self, condition: Callable[[], bool], timeout_s: float) -> bool:
        """Step until `condition` holds; False if it does not within `timeout_s`."""
        for _ in range(max(1, round(timeout_s / TICK_S))):
            if condition():
                return True
            self._wait_for_tick(1)
            self._drained_at = self._ticks // _DRAIN_EVERY
            self.drain()
        return condition()

    def drain(self) -> None:
        """Take what has come on every bus and port and hand it out.

        Whatever fails, the others are looked at all the same; then the first failure is raised.

        Raises:
            BenchError: a bus or a port failed.
        """
        looks = [partial(self._drain, wire) for wire in self.wires]
        _each([*looks, *self._served, *self._drained], self.keep_up)

    def _drain(self, wire: Wire) -> None:
        block = wire.drain()
        if len(block):
            for callback in self._block_callbacks:
                callback(wire.name, block)
            self.keep_up()
            self.hand_out(wire.name, block)

    def _pass(self, ticks: int) -> None:
        self._wait_for_tick(ticks)
        if self._ticks // _DRAIN_EVERY > self._drained_at:
            self._drained_at = self._ticks // _DRAIN_EVERY
            self.drain()

    def _undisturbed(self) -> int:
        """Ticks that may pass at once: up to the next look at the buses or the next duty, it included."""
        if not self.clock.virtual:
            return 1
        to_duty = (self._next_duty_s - self._anchor_s) / TICK_S - self._since_anchor
        to_drain = _DRAIN_EVERY - self._ticks % _DRAIN_EVERY
        return to_drain if to_duty > to_drain else math.ceil(max(1.0, to_duty))

    def _next_ticks(self, count: int) -> npt.NDArray[np.float64]:
        """Times of ticks, seconds: now, and those that follow."""
        times = np.arange(self._since_anchor, self._since_anchor + count, dtype=np.float64)
        times *= TICK_S
        times += self._anchor_s
        times[0] = self.clock.now_s()
        return times

    def _wait_for_tick(self, ticks: int) -> None:
        if self.stop_requested and not self.shielded:
            self.stop_requested = False
            raise InterruptError(self.stop_reason)
        self._since_anchor += ticks
        self.tick_s = next_s = self._anchor_s + self._since_anchor * TICK_S
        self.clock.sleep_until(next_s)
        now_s = self.clock.now_s()
        if self._sending is not None:
            self._sending.next()
        if now_s - next_s > _GIVEN_UP_TICKS * TICK_S:
            # do not chase lost time: devices time out by themselves
            self._anchor_s, self._since_anchor = now_s, 0
        self._ticks += ticks
        if now_s >= self._next_duty_s:
            self._do_duties(now_s)

    def _do_duties(self, now_s: float) -> None:
        self._next_duty_s = np.inf
        duties = [*self._timed, *self._duties]
        try:
            _each([partial(duty.run_if_due, now_s, self.tick_s) for duty in duties], self.keep_up)
        finally:
            nearest_s = min((duty.due_s for duty in duties), default=np.inf) - 0.5 * TICK_S
            self._next_duty_s = min(self._next_duty_s, nearest_s)

    def hand_out(self, name: str, block: FrameBlock) -> None:
        """Call those who wait for single frames of a bus."""
        found = np.empty(len(block), np.int64)
        count = _find(block["id"], block["flags"], self._wanted[name], found)
        for frame in block[found[:count]] if count else ():
            data = int(frame["data"]).to_bytes(8, "little")[: int(frame["length"])]
            self._callbacks[name][int(frame["id"])](int(frame["id"]), data, float(frame["time_s"]))


@compiled
def _find(ids, flags, wanted, found):  # type: ignore[no-untyped-def]
    """Places of the received standard frames whose identifiers are wanted; how many."""
    count = 0
    for place in range(len(ids)):
        if not flags[place] & _OTHERS and wanted[ids[place]]:
            found[count] = place
            count += 1
    return count


def _each(works: Iterable[Callable[[], None]], between: Callable[[], None] = lambda: None) -> None:
    """Do all of it, also after one has failed, and `between` after each; then raise the first failure."""
    failure: Exception | None = None
    for work in works:
        try:
            work()
            between()
        except Exception as error:
            failure = failure or error
    if failure is not None:
        raise failure


class _Sending:
    """What is sent one each tick; `passed`: ticks since the first."""

    def __init__(self, count: int, send: Callable[[int], None]) -> None:
        self._count, self._send = count, send
        self.passed = -1

    def next(self) -> None:
        """A tick has come."""
        if self.passed < self._count:
            self.passed += 1
            if self.passed < self._count:
                self._send(self.passed)


class _Duty:
    def __init__(
        self,
        period_s: float,
        now_s: float,
        run: Callable[[], None],
        done: Callable[[float], None] | None,
    ) -> None:
        self._period_s, self.due_s, self._run, self._done = period_s, now_s, run, done

    def run_if_due(self, now_s: float, tick_s: float) -> None:
        if now_s >= self.due_s - 0.5 * TICK_S:
            meant_s = tick_s if self.due_s < tick_s + 0.5 * TICK_S else self.due_s  # a duty falls on a tick
            self.due_s = max(self.due_s + self._period_s, now_s)
            self._run()
            if self._done is not None:
                self._done(meant_s)
