"""Steps a simulated bench through wall-clock time, and passes frames between it and its wires."""

from __future__ import annotations

import math
import operator
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from hil.core.can.frames import FrameBlock
from hil.core.channels import TICK_S
from hil.core.runtime.clock import undisturbed
from sim_backend.bench import SimulatedBench

_LONGEST_CATCH_UP_S = 0.5  # a host that was held up as well goes on after no longer a pause
_STALL_S = 0.005
_DUTIES_EVERY = 10  # turns

#: A host's frame: when it was sent in seconds since 1970 (None: the wire does not say), identifier, data.
HostFrame = tuple[float | None, int, bytes]


class BusServer(Protocol):
    """One bus of the bench on a wire."""

    @property
    def table(self) -> Mapping[str, Any]:
        """What a bench file says to reach it: keys of [buses.NAME]."""
        ...

    @property
    def lost(self) -> int:
        """Frames that are known to have been lost on the way."""
        ...

    def take(self) -> list[HostFrame]:
        """Frames of hosts since the last call, in their order. Never waits."""
        ...

    def give(self, block: FrameBlock) -> None:
        """Frames of the bench, stamps in seconds since 1970. Never waits."""
        ...

    def close(self) -> None:
        """Let go of the wire."""
        ...


@dataclass
class Pace:
    """How well the wall clock was kept; seconds of the wall clock where nothing else is stated.

    Attributes:
        turns: looks at the wires, one each millisecond of bench time.
        stalls: turns that came more than 5 ms late.
        largest_stall_s: latest of them.
        bench_time_s: seconds of bench time that passed.
        left_out_s: seconds of bench time by which the bench's clock was put back after stalls that were too
            long to be caught up with, whole milliseconds at a time.
    """

    turns: int = 0
    stalls: int = 0
    largest_stall_s: float = 0.0
    bench_time_s: float = 0.0
    left_out_s: float = 0.0


class BenchServer:
    """A bench and its buses on their wires.

    Args:
        time_scale: seconds of bench time in a second of the wall clock.
        duties: called a hundred times a second of bench time: what serves lines that are no buses.
        clock: seconds of the wall clock, monotonic.
        sleep: waits for some seconds of it.
    """

    def __init__(
        self,
        world: SimulatedBench,
        buses: Mapping[str, BusServer],
        time_scale: float = 1.0,
        *,
        duties: Sequence[Callable[[], None]] = (),
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self._world, self.buses, self._scale = world, dict(buses), time_scale
        self._clock, self._sleep, self._duties = clock, sleep, duties
        self.pace = Pace()
        self.frames: dict[str, list[int]] = {bus: [0, 0] for bus in buses}  # sent, received
        self._world.sleep_until(world.now_s() + TICK_S)  # what is compiled is compiled before time counts
        for bus in buses:
            world.take(bus)

    def serve(self, stop: Callable[[], bool], for_s: float = float("inf")) -> None:
        """Serve until `stop` says so, at most `for_s` of the wall clock."""
        with undisturbed(collections=False):
            start_s = self._clock()
            first_s = self._world.now_s()
            origin_s = start_s - first_s / self._scale  # when bench time was 0
            epoch_s = time.time() - start_s
            turn = 0
            while not stop() and self._clock() - start_s < for_s:
                origin_s += self._turn(origin_s, epoch_s)
                turn += 1
                if turn % _DUTIES_EVERY == 0:
                    for duty in self._duties:
                        duty()
                self.pace.bench_time_s = self._world.now_s() - first_s
                next_s = origin_s + (self._world.now_s() + TICK_S) / self._scale
                self._sleep(max(0.0, next_s - self._clock()))

    def close(self) -> None:
        """Let go of every wire."""
        for bus in self.buses.values():
            bus.close()

    def _turn(self, origin_s: float, epoch_s: float) -> float:
        """One look at everything; seconds of the wall clock that are left out."""
        world, pace = self._world, self.pace
        behind_s = (self._clock() - origin_s) * self._scale - world.now_s() - TICK_S
        late_s = behind_s / self._scale
        pace.turns += 1
        pace.stalls += late_s > _STALL_S
        pace.largest_stall_s = max(pace.largest_stall_s, late_s)
        left_out_s = TICK_S * max(0.0, math.ceil((behind_s - _LONGEST_CATCH_UP_S) / TICK_S))
        pace.left_out_s += left_out_s
        origin_s += left_out_s / self._scale
        until_s = max(world.now_s(), (self._clock() - origin_s) * self._scale)
        for time_s, name, frame_id, data in self._heard(origin_s + epoch_s, until_s):
            world.sleep_until(time_s)
            world.put(name, frame_id, data)
        world.sleep_until(until_s)
        for name, bus in self.buses.items():
            block = world.take(name)
            if len(block):
                block["time_s"] = epoch_s + origin_s + block["time_s"] / self._scale
                bus.give(block)
                self.frames[name][0] += len(block)
        return left_out_s / self._scale

    def _heard(self, zero_s: float, until_s: float) -> list[tuple[float, str, int, bytes]]:
        """Frames of all hosts, each at the bench time at which it was sent.

        After a pause they are not to reach the bench all at once: the RMCU would take that for silence of its
        host. Where the wire does not say when they were sent, they are spread over the pause.
        """
        now_s, heard = self._world.now_s(), []
        for name, bus in self.buses.items():
            frames = bus.take()
            self.frames[name][1] += len(frames)
            for number, (sent_s, frame_id, data) in enumerate(frames):
                if sent_s is None:
                    time_s = now_s + (until_s - now_s) * number / len(frames)
                else:
                    time_s = min(max((sent_s - zero_s) * self._scale, now_s), until_s)
                heard.append((time_s, name, frame_id, data))
        return sorted(heard, key=operator.itemgetter(0))
