"""The other end of each transport: what a test puts there, and what it finds there."""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any, Protocol

import can
import numpy as np

from drivers import CanSettings
from hil.core.can.frames import EXTENDED, FRAME, FrameBlock
from hil.core.model import load_model
from sim_backend.bench import SimulatedBench, SimulationSettings
from sim_backend.can_interface import attach, detach
from sim_backend.serving import BusServer, SlcanPort, SocketcandPort, UdpHub
from tests.benches_for_tests import SIM

BIT_RATE = 1_000_000


class FarEnd(Protocol):
    """What stands at the other end."""

    settings: CanSettings

    def put(self, block: FrameBlock) -> None: ...

    def taken(self) -> list[tuple[int, bytes]]: ...

    def leave(self) -> None: ...


class Served:
    """A bus as `hil bench sim` serves it; somebody looks at it while it is opened."""

    def __init__(self, server: BusServer) -> None:
        self.server = server
        table = dict(server.table)
        self.settings = CanSettings("bus", table["interface"], table["channel"], BIT_RATE,
                                    options=table.get("options", {}))  # fmt: skip

    def put(self, block: FrameBlock) -> None:
        while isinstance(self.server, SocketcandPort) and not all(host.raw for host in self.server._hosts):
            time.sleep(0.01)
        self.server.give(block)

    def taken(self) -> list[tuple[int, bytes]]:
        return [(frame_id, data) for _, frame_id, data in self.server.take()]

    def leave(self) -> None:
        self.server.close()


class Virtual:
    """python-can's own bus inside of a process."""

    def __init__(self) -> None:
        self.settings = CanSettings(
            "bus", "virtual", "far-end", BIT_RATE, options={"preserve_timestamps": True}
        )
        self._bus = can.Bus(interface="virtual", channel="far-end", preserve_timestamps=True)

    def put(self, block: FrameBlock) -> None:
        for frame in block:
            data = int(frame["data"]).to_bytes(8, "little")[: int(frame["length"])]
            extended = bool(frame["flags"] & EXTENDED)
            self._bus.send(can.Message(float(frame["time_s"]), int(frame["id"]), extended, data=data))

    def taken(self) -> list[tuple[int, bytes]]:
        found = []
        while (message := self._bus.recv(0)) is not None:
            found.append((message.arbitration_id, bytes(message.data)))
        return found

    def leave(self) -> None:
        self._bus.shutdown()


class Simulated:
    """The simulated bench in virtual time: it sends what its devices send."""

    def __init__(self) -> None:
        self.world = SimulatedBench(
            SimulationSettings(load_model(SIM.simulation.model), SIM.rmcu.dbc, SIM.dyno.eds)
        )
        attach("far-end", self.world)
        self.settings = CanSettings("bus", "hil-sim", "far-end/dyno", BIT_RATE)
        self._heard: list[tuple[int, bytes]] = []
        node: Any = self.world.dynos[0]
        self._hear, node.receive = node.receive, self._receive

    def _receive(self, frame_id: int, data: bytes, time_s: float) -> None:
        self._heard.append((frame_id, data))
        self._hear(frame_id, data, time_s)

    def put(self, block: FrameBlock) -> None:
        raise NotImplementedError

    def taken(self) -> list[tuple[int, bytes]]:
        self.world.sleep_until(self.world.now_s() + 0.001)
        assert self.world.dynos  # what passes unseen is computed when somebody looks
        heard, self._heard = self._heard, []
        return heard

    def leave(self) -> None:
        detach("far-end")


FAR_ENDS: dict[str, Callable[[], FarEnd]] = {
    "virtual": Virtual,
    "hil-sim": Simulated,
    "hil-udp": lambda: Served(UdpHub(0, BIT_RATE, 1.0)),
    "slcan": lambda: Served(SlcanPort(BIT_RATE)),
    "socketcand": lambda: Served(SocketcandPort(0, "bus")),
}


@contextlib.contextmanager
def looked_after(far: FarEnd) -> Iterator[None]:
    """Somebody at the other end answers to being opened."""
    done = threading.Event()

    def look() -> None:
        while not done.wait(0.001):
            far.taken()

    thread = threading.Thread(target=look)
    thread.start()
    try:
        yield
    finally:
        done.set()
        thread.join()


def block_of(ids: Any, *, stamp_s: float = 0.0, flags: int = 0) -> FrameBlock:
    """Frames that tell each other apart by their data, which has 0 to 8 bytes."""
    block = np.zeros(len(ids), FRAME)
    block["time_s"] = stamp_s + 0.0001 * np.arange(len(ids))
    block["id"], block["flags"] = ids, flags
    block["length"] = np.arange(len(ids)) % 9
    for frame in block:
        frame["data"] = int.from_bytes(bytes(range(1, 1 + int(frame["length"]))), "little")
    return block
