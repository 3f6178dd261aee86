"""Channels that no device measures, computed where a bench file limits them.

Shaft twist, what the inverter's torque misses, health of buses: samples of a stream like any other, watched
and recorded.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from typing import Protocol

import numpy as np

from drivers import TICK_S, BusLoop, Samples, Stream, bits_on_the_wire
from hil.core.can.frames import ERROR_FRAME, FrameBlock
from hil.core.runtime.compiled import compiled
from hil.engine.bench.bench_tables import BenchFile
from hil.engine.bench.ranges import TwistTable
from test_plans import Array

TWIST = "shaft_twist_rad"
TORQUE_ERROR = "motor_torque_error_nm"
_TORQUE, _ASKED = "motor_torque_nm", "motor_torque_ref_nm"
_MOTOR, _WHEELS = "motor_speed_rad_s", ("wheel_speed_left_rad_s", "wheel_speed_right_rad_s")
_LOOK_S = 0.1  # over so long the load of a bus is taken
_LONGEST_GAP_S = 0.1  # nothing is integrated over a longer one


class Computed(Protocol):
    """A sample source that is also shown what the devices gave."""

    @property
    def streams(self) -> Sequence[Stream]:
        """What it gives."""
        ...

    def samples(self) -> Iterable[Samples]:
        """What has been computed since the last call."""
        ...

    def take(self, samples: Samples) -> None:
        """Look at samples of a device."""
        ...


def computed_channels(file: BenchFile, loop: BusLoop) -> list[Computed]:
    """What of it the bench file limits."""
    limited = {*file.limits.channels, *(named.channel for named in file.limits.watch.values())}
    limited |= {lock.channel for lock in file.interlocks.values()}
    found: list[Computed] = []
    if file.limits.twist and TWIST in limited:
        found.append(ShaftTwist(file.limits.twist))
    if TORQUE_ERROR in limited:
        found.append(TorqueError())
    for name, bus in file.buses.items():
        if limited & set(channels_of_bus(name)):
            health = BusStatistics(loop, name, bus.bit_rate)
            loop.on_block(health.take_frames)
            found.append(health)
    return found


def channels_of_bus(name: str) -> tuple[str, str]:
    """Share of the time in which frames are on a bus, and error frames so far."""
    plain = re.sub(r"\W", "_", name, flags=re.ASCII)
    return f"bus_load_{plain}", f"bus_error_frames_{plain}"


class ShaftTwist:
    """Integrates motor speed over gear ratio less the mean wheel speed: the angle by which the shafts twist.

    The integral begins at 0 and forgets with a time constant, so that an offset of a speed sensor does not
    add up: with 2 s an offset of 0.01 rad/s reads as 0.02 rad. A twist that stands is therefore limited by
    the shaft torque, a quick one by this. Wheel speeds are taken at the times of the motor speed's samples.
    """

    def __init__(self, table: TwistTable) -> None:
        self._ratio, self._forget_s = table.gear_ratio, table.forget_s
        # What is missing here is missing in the devices' own streams, which are the first to say so.
        self.streams = (Stream("shaft twist", "computed", (TWIST,), ("rad",), TICK_S, silence_s=0.3),)
        self._motor = _Waiting()
        self._wheels = {name: _Waiting() for name in _WHEELS}
        self._state = np.array([0.0, math.nan])  # twist, rad, and the time of it, s

    def take(self, samples: Samples) -> None:
        """Keep speeds."""
        for place, channel in enumerate(samples.stream.channels):
            if channel == _MOTOR:
                self._motor.add(samples.time_s, samples.values[:, place])
            elif channel in self._wheels:
                self._wheels[channel].add(samples.time_s, samples.values[:, place])

    def samples(self) -> list[Samples]:
        """As far as all three speeds have come."""
        wheels = list(self._wheels.values())
        until_s = min(speed.newest_s for speed in (self._motor, *wheels))
        times_s, motor = self._motor.taken(until_s)
        if not len(times_s):
            return []
        difference = motor / self._ratio - 0.5 * sum(wheel.at(times_s) for wheel in wheels)
        twist = np.empty(len(times_s))
        _integrate(times_s, difference, self._forget_s, self._state, twist)
        return [Samples(self.streams[0], times_s, twist[:, None])]


class TorqueError:
    """What the inverter says that it gives, less what it was asked for, of the same sample.

    It is reported late by the inverter's own lag: a limit of it needs a persistence longer than that.
    """

    def __init__(self) -> None:
        self.streams = (Stream("torque error", "computed", (TORQUE_ERROR,), ("N m",), TICK_S, silence_s=0.3),)
        self._computed: list[Samples] = []

    def take(self, samples: Samples) -> None:
        """Compute it of a stream that has both."""
        channels = samples.stream.channels
        if _TORQUE in channels and _ASKED in channels:
            given, asked = (samples.values[:, channels.index(name)] for name in (_TORQUE, _ASKED))
            self._computed.append(Samples(self.streams[0], samples.time_s, (given - asked)[:, None]))

    def samples(self) -> list[Samples]:
        """As far as both have come."""
        found, self._computed = self._computed, []
        return found


class _Waiting:
    """Samples of one speed that have not been used yet."""

    def __init__(self) -> None:
        self._times_s, self._values = np.zeros(0), np.zeros(0)

    @property
    def newest_s(self) -> float:
        return float(self._times_s[-1]) if len(self._times_s) else -math.inf

    def add(self, times_s: Array, values: Array) -> None:
        self._times_s = np.concatenate([self._times_s, times_s])
        self._values = np.concatenate([self._values, values])

    def taken(self, until_s: float) -> tuple[Array, Array]:
        """Samples until a time; they are gone then."""
        count = int(np.searchsorted(self._times_s, until_s, side="right"))
        found = self._times_s[:count], self._values[:count]
        self._times_s, self._values = self._times_s[count:], self._values[count:]
        return found

    def at(self, times_s: Array) -> Array:
        """Values at these times; what is older than the newest of them is forgotten."""
        values = np.interp(times_s, self._times_s, self._values)
        kept = max(0, int(np.searchsorted(self._times_s, times_s[-1], side="right")) - 1)
        self._times_s, self._values = self._times_s[kept:], self._values[kept:]
        return values


@compiled
def _integrate(times_s, difference, forget_s, state, twist):  # type: ignore[no-untyped-def]
    """Twist at each time; NaN where a speed is not known, and from the value before it afterwards."""
    for k in range(times_s.shape[0]):
        step_s = times_s[k] - state[1]
        state[1] = times_s[k]
        if np.isnan(difference[k]):
            twist[k] = np.nan
            continue
        if 0.0 < step_s < _LONGEST_GAP_S:
            state[0] += step_s * (difference[k] - state[0] / forget_s)
        twist[k] = state[0]


class BusStatistics:
    """Load and error frames of one CAN bus, ten times a second."""

    def __init__(self, loop: BusLoop, name: str, bit_rate: int) -> None:
        self._clock, self._name, self._bit_rate = loop.clock, name, bit_rate
        self.streams = (
            Stream(f"health of bus '{name}'", "computed", channels_of_bus(name), ("1", "1"), _LOOK_S, 1.0),
        )
        self._since_s = loop.clock.now_s()
        self._bits = self._errors = 0

    def take_frames(self, bus: str, block: FrameBlock) -> None:
        """Count what is sent and received on a bus."""
        if bus == self._name:
            self._bits += int(bits_on_the_wire(block).sum())
            self._errors += int(np.count_nonzero(block["flags"] & ERROR_FRAME))

    def take(self, samples: Samples) -> None:
        """Not needed."""

    def samples(self) -> list[Samples]:
        """One each time that the load has been counted for long enough."""
        now_s = self._clock.now_s()
        passed_s = now_s - self._since_s
        if passed_s < _LOOK_S - 0.5 * TICK_S:
            return []
        load = self._bits / self._bit_rate / passed_s
        self._since_s, self._bits = now_s, 0
        return [Samples(self.streams[0], np.array([now_s]), np.array([[load, float(self._errors)]]))]
