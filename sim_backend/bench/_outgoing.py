"""Frames of the simulated bench that wait: those of hosts until their sample, those of nodes until taken."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from hil.core.can.frames import FrameBlock, empty_block, frames, joined
from hil.core.can.signals import FrameLayout
from hil.core.channels import TICK_S
from hil.core.errors import BadInputError
from hil.plant.closed_loop import tick as T
from sim_backend.bench._traffic import CyclicTraffic, DaqTraffic, EventSlots, Shown
from sim_backend.rcs import DynoNode
from sim_backend.rmcu import DaqList, RamSettings, RmcuMemory, RmcuNode


class Sent(NamedTuple):
    """A host's frame: its payload as a little-endian number, and the sample that it comes before."""

    sample: int
    bus: str
    frame_id: int
    payload: int
    length: int

    @property
    def data(self) -> bytes:
        """Its payload."""
        return self.payload.to_bytes(8, "little")[: self.length]


class Inbox:
    """Frames in order of the samples that they come before; torque requests bind no batch of samples.

    Args:
        request: bus and identifier of torque requests, which a batch takes in its stride.
    """

    def __init__(self, request: tuple[str, int]) -> None:
        self._request = request
        self._sent: deque[Sent] = deque()
        self._breaks: deque[int] = deque()  # samples before which more comes than a torque request

    def put(self, sample: int, bus: str, frame_id: int, data: bytes) -> None:
        """A frame that comes before `sample`."""
        self.put_all([sample], bus, frame_id, [int.from_bytes(data, "little")], len(data))

    def put_all(self, samples: list[int], bus: str, frame_id: int, payloads: list[int], length: int) -> None:
        """Frames of one identifier, each before its sample, in order."""
        for sample, payload in zip(samples, payloads, strict=True):
            self._sent.append(Sent(sample, bus, frame_id, payload, length))
        if (bus, frame_id) != self._request:
            self._breaks.extend(samples)

    def until(self, sample: int) -> Iterator[Sent]:
        """What comes before `sample` or earlier, taken out one by one."""
        while self._sent and self._sent[0].sample <= sample:
            yield self._sent.popleft()
        while self._breaks and self._breaks[0] <= sample:
            self._breaks.popleft()

    def next_break(self, end: int) -> int:
        """The sample where a batch has to end: `end`, or where more comes than a torque request."""
        return min(end, self._breaks[0]) if self._breaks else end

    def requests_before(self, end: int) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.uint64]]:
        """The samples before which torque requests come, earlier than `end`, and these, taken out."""
        lines = []
        while self._sent and self._sent[0].sample < end:
            lines.append(self._sent.popleft())
        return np.array([c.sample for c in lines], np.int64), np.array([c.payload for c in lines], np.uint64)


RMCU_BUS, DYNO_BUS, RAM_BUS = "rmcu", "dyno", "ram"
_SYNC = FrameLayout("SYNC", 0x80, 0, {})


class Outgoing:
    """All buses; the nodes are given by `nodes_are` once they are there.

    Args:
        vehicle: layout of the frame in which the dyno controller tells the RMCU the vehicle's speed.
        ram: on which bus the RMCU's memory is looked at, if it is.
    """

    def __init__(
        self, rmcu_bit_rate: int, dyno_bit_rate: int, vehicle: FrameLayout, ram: RamSettings | None = None
    ) -> None:
        self._bit_rates = {RMCU_BUS: rmcu_bit_rate, DYNO_BUS: dyno_bit_rate}
        self._ram = ram
        if ram is not None:
            self._bit_rates.setdefault(ram.bus, ram.bit_rate)
        self._measured: list[DaqTraffic] = []
        self._later: list[FrameBlock] = []  # measured data that cross their bus after the newest sample
        self._slots = {bus: EventSlots(rate) for bus, rate in self._bit_rates.items()}
        self._pending: dict[str, list[FrameBlock]] = {bus: [] for bus in self._bit_rates}
        self._vehicle = vehicle
        self._of_dynos: dict[tuple[bool, ...], CyclicTraffic] = {}  # by who is operational

    def nodes_are(self, rmcu: RmcuNode, dynos: list[DynoNode], request_s: float) -> None:
        """Who sends from now on.

        Args:
            request_s: how long a host's torque request takes on the RMCU's bus; it comes every millisecond.

        Raises:
            BadInputError: a bus is too slow for the frames of every millisecond.
        """
        self._rmcu, self._dynos = rmcu, dynos
        self.rmcu_talks(True)
        self.dynos_changed()
        self._slots[RMCU_BUS].begin_s = self._rmcu_traffic.time_s + request_s
        self._slots[DYNO_BUS].begin_s = self._dyno_traffic_of((True, True)).time_s
        self._cyclic_s = {bus: slots.begin_s for bus, slots in self._slots.items()}
        self._refuse_slow_buses()

    def rmcu_talks(self, talks: bool) -> None:
        """Whether the RMCU sends its frames every sample; the vehicle's speed comes either way."""
        shown: list[Shown] = [
            (self._vehicle, {"VehicleSpeed": T.VEHICLE_SPEED, "Counter": T.COUNTER, "Valid": T.ALWAYS_ONE})
        ]
        if talks:
            shown += _shown_by(self._rmcu)
        checked = [self._vehicle.id, self._rmcu.control.id]
        checked += [self._rmcu.status.id] if "Crc" in self._rmcu.status.signals else []
        self._rmcu_traffic = CyclicTraffic(shown, self._bit_rates[RMCU_BUS], tuple(checked))

    def dynos_changed(self) -> None:
        """Look again at what NMT and the SYNC producer let the dynos send."""
        if any(node.sync_period_s for node in self._dynos):
            operational = tuple(node.operational for node in self._dynos[:2])
            self._dyno_traffic: CyclicTraffic | None = self._dyno_traffic_of(operational)
        else:
            self._dyno_traffic = None

    def measures(self, lists: list[DaqList], memory: RmcuMemory) -> bool:
        """Which lists are sent from now on; false if their bus has no room for so many samples."""
        assert self._ram is not None
        bus = self._ram.bus
        begin_s = self._cyclic_s.get(bus, 0.0)
        self._measured = []
        for daq in lists:
            traffic = DaqTraffic(daq, memory, self._ram.answer_id, self._bit_rates[bus], begin_s)
            self._measured.append(traffic)
            begin_s = traffic.begin_s
        self._slots[bus].begin_s = begin_s
        return not any(traffic.overloaded for traffic in self._measured)

    def event(self, bus: str, sample: int, frame_id: int, data: bytes) -> None:
        """A frame that answers or announces something, in a sample."""
        stamp = self._slots[bus].next_s(sample)
        self._pending[bus].append(frames(frame_id, int.from_bytes(data, "little"), len(data), stamp))

    def cyclic(self, rows: npt.NDArray[np.float64], first: int) -> None:
        """The frames of sample `first` and those that follow it; one row of the bench each."""
        self._pending[RMCU_BUS].append(self._rmcu_traffic.block(rows, first))
        if self._dyno_traffic:
            self._pending[DYNO_BUS].append(self._dyno_traffic.block(rows, first))
        if self._measured or self._later:
            self._measure(rows, first)

    def _measure(self, rows: npt.NDArray[np.float64], first: int) -> None:
        assert self._ram is not None
        frames = joined([*self._later, *(traffic.block(rows, first) for traffic in self._measured)])
        late = frames["time_s"] > (first + len(rows)) * TICK_S + 1e-9
        self._pending[self._ram.bus].append(frames[~late])
        self._later = [frames[late]] if np.any(late) else []

    def taken(self, bus: str) -> FrameBlock:
        """All that was sent on `bus` and not taken yet, in order of time."""
        blocks = self._pending[bus]
        if not blocks:
            return empty_block()
        self._pending[bus] = []
        merged = joined(blocks)
        mixed = self._ram is not None and bus == self._ram.bus
        if mixed or any(a["time_s"][-1] > b["time_s"][0] for a, b in pairwise(blocks)):
            merged = merged[np.argsort(merged["time_s"], kind="stable")]
        return merged

    def _dyno_traffic_of(self, operational: tuple[bool, ...]) -> CyclicTraffic:
        if operational not in self._of_dynos:
            shown: list[Shown] = [(_SYNC, {})]
            for side, node in enumerate(self._dynos[:2]):
                if operational[side]:
                    shown += _shown_by_dyno(node, side)
            self._of_dynos[operational] = CyclicTraffic(shown, self._bit_rates[DYNO_BUS])
        return self._of_dynos[operational]

    def _refuse_slow_buses(self) -> None:
        """A millisecond's frames must fit into a millisecond, or they would never arrive in order."""
        for bus, slots in self._slots.items():
            if slots.begin_s > TICK_S:
                least = math.ceil(slots.bit_rate * slots.begin_s / TICK_S / 1e4) * 10_000
                raise BadInputError(
                    f"bit_rate = {slots.bit_rate} bit/s is too slow: the frames of each millisecond take "
                    f"{slots.begin_s * 1e3:.2g} ms",
                    where=f"simulated bench, bus of the {bus}",
                    fix=f"give at least {least} bit/s",
                )


def _shown_by(rmcu: RmcuNode) -> list[Shown]:
    status = {"MotorSpeed": T.MOTOR_SPEED, "MotorTorqueRef": T.TORQUE_REF, "MotorTorque": T.TORQUE}
    if "Counter" in rmcu.status.signals:
        status["Counter"] = T.COUNTER
    control = {
        "DrivingTorqueRef": T.DRIVING_REF,
        "DrivingTorqueEst": T.DRIVING_EST,
        "State": T.STATE,
        "RequestFault": T.FAULT,
        "Saturated": T.SATURATED,
        "ParametersValid": T.PARAMETERS_VALID,
        "Counter": T.COUNTER,
    }
    return [(rmcu.status, status), (rmcu.control, control)]


def _shown_by_dyno(node: DynoNode, side: int) -> list[Shown]:
    values = {"Wheel speed": T.WHEEL_LEFT + side, "Shaft torque": T.SHAFT_LEFT + side}
    status = {
        "Statusword": T.STATUS_LEFT + side,
        "Vehicle speed": T.VEHICLE_SPEED,
        "Torque actual value": T.LOAD_LEFT + side,
    }
    return [(node.values, values), (node.status, status)]
