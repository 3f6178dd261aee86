"""The simulated bench as a python-can interface: `can.Bus(interface="hil-sim", channel="NAME/rmcu")`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import can
import numpy as np
import numpy.typing as npt

from hil.core.can.frames import FrameBlock
from sim_backend.bench import SimulatedBench

_BENCHES: dict[str, SimulatedBench] = {}
_PREPARED: dict[str, Callable[[SimulatedBench], None]] = {}


def attach(name: str, bench: SimulatedBench) -> None:
    """Make a bench reachable under `name` in this process."""
    _BENCHES[name] = bench
    if name in _PREPARED:
        _PREPARED[name](bench)


def prepare(name: str, work: Callable[[SimulatedBench], None]) -> None:
    """Have `work` done on every bench that is made reachable under `name` from now on: to break it."""
    _PREPARED[name] = work


def detach(name: str) -> None:
    """Forget a bench; unknown names are no error."""
    _BENCHES.pop(name, None)


def attached(name: str) -> SimulatedBench:
    """The bench that is reachable under `name`; KeyError if there is none."""
    return _BENCHES[name]


class SimulatedBus(can.BusABC):
    """One bus of a simulated bench. Waiting for a frame makes the bench's virtual time pass.

    Beside python-can's interface it has `recv_block`, which gives all waiting frames, `send_frame`, which
    needs no message object, and `send_ahead`; message by message gives the same frames.
    """

    def __init__(self, channel: str, **kwargs: Any) -> None:
        name, _, self._bus = str(channel).partition("/")
        if name not in _BENCHES:
            raise can.CanInitializationError(
                f"no simulated bench '{name}' is running in this process (channel '{channel}')"
            )
        self._bench = _BENCHES[name]
        if self._bus not in self._bench.buses:
            known = " and ".join(f"'{bus}'" for bus in self._bench.buses)
            raise can.CanInitializationError(
                f"this simulated bench has the buses {known} (channel '{channel}')"
            )
        self._waiting: list[can.Message] = []
        self.channel_info = f"simulated bench {channel}"
        super().__init__(channel=channel, **kwargs)

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Put a frame on the bus."""
        del timeout
        self._bench.put(self._bus, msg.arbitration_id, bytes(msg.data))

    def send_frame(self, frame_id: int, data: bytes) -> None:
        """Put a standard data frame on the bus."""
        self._bench.put(self._bus, frame_id, data)

    def send_ahead(
        self,
        frame_id: int,
        payloads: npt.NDArray[np.uint64],
        length: int,
        times_s: npt.NDArray[np.float64],
    ) -> None:
        """Put standard data frames on the bus, each at its time, s of the bench's clock, in order."""
        self._bench.put_ahead(self._bus, frame_id, payloads, length, times_s)

    def recv_block(self) -> FrameBlock:
        """All frames that arrived until now."""
        return self._bench.take(self._bus)

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        end_s = self._bench.now_s() + (60.0 if timeout is None else timeout)
        while not self._waiting:
            self._waiting = [_message(frame) for frame in self._bench.take(self._bus)][::-1]
            if self._waiting or self._bench.now_s() >= end_s:
                break
            self._bench.sleep_until(min(end_s, self._bench.now_s() + 0.001))
        return (self._waiting.pop() if self._waiting else None), True


def _message(frame: np.void) -> can.Message:
    length = int(frame["length"])
    return can.Message(
        timestamp=float(frame["time_s"]),
        arbitration_id=int(frame["id"]),
        is_extended_id=False,
        data=int(frame["data"]).to_bytes(8, "little")[:length],
    )
