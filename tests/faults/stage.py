"""A run on the simulated bench in which one fault is injected in one phase: when, how often, how much torque.

The bench's clock says that it is no virtual one, so that everything goes tick by tick as on hardware; waiting
takes no time all the same. Torque is read from the plant's own log, not from what hosts were reported.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from hil.core.can.frames import FrameBlock
from hil.core.channels import TICK_S
from hil.plant.closed_loop import tick as T
from sim_backend.bench import RMCU_BUS, SimulatedBench
from sim_backend.can_interface import prepare
from sim_backend.rcs import State

BENCH = "faults"
#: Phases of a run in their order, and how long after its beginning a fault is injected, s of bench time.
PHASES = {
    "pre-flight": 0.15,
    "arming": 0.0,
    "holding speed": 0.3,
    "stepping": 0.4,
    "prompting": 0.2,
    "analysing": 0.2,
    "ramping down": 0.2,
    "writing": 0.0,
}
_ON_NM = 1e-6


class Injection:
    """A fault: `begin` when its time has come; from then on it is asked about all that passes on the wires.

    Whatever really changes something tells it to the stage by `count`.
    """

    def plug(self, stage: Stage) -> None:
        """Before the run: what is to lie in wait."""

    def begin(self, stage: Stage) -> None:
        """Now."""

    def to_hosts(self, stage: Stage, bus: str, block: FrameBlock) -> FrameBlock:
        """What hosts get of the frames of a bus."""
        del stage, bus
        return block

    def to_nodes(self, stage: Stage, bus: str, frame_id: int, data: bytes) -> Iterable[tuple[int, bytes]]:
        """What nodes get of a host's frame."""
        del stage, bus
        return [(frame_id, data)]


class Stage:
    """Stands between host and bench: a `sim_backend.bench.Tamper`."""

    current: Stage

    def __init__(self, phase: str, injection: Injection, request_id: int) -> None:
        self._phase, self._injection, self._request_id = phase, injection, request_id
        self.world: Any = None
        self.injected_s: float | None = None
        self.counted = 0
        # When the RMCU asked the inverter for any first and last, by the plant's log
        self.first_torque_s = self.last_torque_s = 0.0
        self.largest_nm = 0.0
        self._phase_s: dict[str, float] = {"pre-flight": 0.0}
        self.armed = self._busy = False

    def begin(self) -> None:
        """Lie in wait for the bench."""
        Stage.current = self
        self._injection.plug(self)
        prepare(BENCH, self._attached)

    def _attached(self, world: SimulatedBench) -> None:
        self.world = world
        self.world.virtual = False
        world.tamper = self

    @property
    def now_s(self) -> float:
        return float(self.world.now_s())

    def enter(self, phase: str) -> None:
        """A phase of the run begins."""
        if self.world is not None:  # a rehearsal is none
            self._phase_s.setdefault(phase, self.now_s)

    def let_time_pass(self, duration_s: float) -> None:
        """The run is over: what becomes of the bench that no one looks after."""
        if self.world is not None:
            self.world.sleep_until(self.now_s + duration_s)
            self.world.take(RMCU_BUS)

    def count(self, times: int = 1) -> None:
        """The fault has really been injected."""
        self.counted += times

    # --- between the nodes and the host ---

    def time_passes(self, now_s: float) -> None:
        if self._busy or self.injected_s is not None:
            return
        if self._phase == "writing" and self.armed and "writing" not in self._phase_s:
            self._busy = True
            if all(node.power.state is State.SWITCH_ON_DISABLED for node in self.world.dynos):
                self._phase_s["writing"] = now_s
            self._busy = False
        began_s = self._phase_s.get(self._phase)
        if began_s is not None and now_s >= began_s + PHASES[self._phase]:
            self.injected_s = now_s
            self._busy = True
            self._injection.begin(self)
            self._busy = False

    def to_hosts(self, bus: str, block: FrameBlock) -> FrameBlock:
        if self.injected_s is None:
            return block
        return self._injection.to_hosts(self, bus, block)

    def to_nodes(self, bus: str, frame_id: int, data: bytes) -> Iterable[tuple[int, bytes]]:
        if bus == RMCU_BUS and frame_id == self._request_id:
            self.enter("arming")
        if not self.armed and self.world.dynos[0].power.state is State.OPERATION_ENABLED:
            self.armed = True
        if self.injected_s is None:
            return [(frame_id, data)]
        return self._injection.to_nodes(self, bus, frame_id, data)

    def look(self, first: int, rows: npt.NDArray[np.float64]) -> None:
        asked = np.abs(rows[:, T.TORQUE_REF])
        on = np.flatnonzero(asked > _ON_NM)
        if len(on):
            self.first_torque_s = self.first_torque_s or float(first + on[0]) * TICK_S
            self.last_torque_s = float(first + on[-1] + 1) * TICK_S
            self.largest_nm = max(self.largest_nm, float(asked.max()))
