"""The simulated bench behind adapters that stamp its frames late: in bursts, after pauses, one by one."""

from __future__ import annotations

from typing import Any

import can
import numpy as np
import numpy.typing as npt
from can.interfaces import BACKENDS

from hil.core.can.frames import FrameBlock
from sim_backend.can_interface import SimulatedBus
from sim_backend.udp_interface import LoopbackBus
from tests.benches_for_tests import sim_bench

BACKENDS["late-stamps"] = ("tests.late_stamps", "LateStamps")
BACKENDS["late-udp"] = ("tests.late_stamps", "LateUdp")
_PAUSE_S = 0.05

Stamps = npt.NDArray[np.float64]


def made_late(stamps: Stamps, late: str, random: np.random.Generator) -> Stamps:
    """Stamps in s of the bench's time, made late.

    - "bursts": at the end of the 2 ms in which they came.
    - "pauses": now and then for 50 ms at the end of them, as if no one had looked.
    - "outliers": now and then one by up to 50 ms.
    """
    if late == "bursts":
        return np.ceil(stamps / 0.002) * 0.002
    if late == "pauses":
        started = np.floor(stamps / 0.731) * 0.731  # a pause every 0.731 s
        return np.maximum(stamps, np.where(stamps < started + _PAUSE_S, started + _PAUSE_S, 0.0))
    if late == "outliers":
        hit = random.random(len(stamps)) < 2e-3
        return stamps + hit * random.uniform(0.02, _PAUSE_S, len(stamps))
    return stamps


class LateStamps(SimulatedBus):
    """A simulated bus whose frames come as ever but are stamped `late`; `seed` and bus say which."""

    def __init__(self, channel: str, late: str, seed: int = 0, **kwargs: Any) -> None:
        super().__init__(channel, **kwargs)
        self._late = late
        self._random = np.random.default_rng([seed, *channel.encode()])

    def recv_block(self) -> FrameBlock:
        """All frames that arrived until now."""
        block = super().recv_block().copy()
        block["time_s"] = made_late(block["time_s"], self._late, self._random)
        return block

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        raise NotImplementedError("frames are taken in blocks")


class LateUdp(LoopbackBus):
    """A bus of a bench in another process whose frames come as ever but are stamped `late`."""

    def __init__(self, channel: str, late: str, **kwargs: Any) -> None:
        super().__init__(channel, **kwargs)
        self._late = late
        self._random = np.random.default_rng(7)

    def recv_epoch_block(self) -> FrameBlock:
        """All frames that arrived until now; the longer a second of the bench, the later they are stamped."""
        block = super().recv_epoch_block().copy()
        if len(block):
            origin_s = np.floor(block["time_s"][0])
            stamps = (block["time_s"] - origin_s) * self.time_scale
            block["time_s"] = origin_s + made_late(stamps, self._late, self._random) / self.time_scale
        return block


def late_bench(name: str, late: str, seed: int = 0, **changes: Any) -> Any:
    """The simulated bench behind such adapters."""
    bench = sim_bench(name, **changes)
    return _behind(bench, "late-stamps", late, seed=seed)


def late_served_bench(bench: Any, late: str) -> Any:
    """A bench in another process behind such adapters; own frames come back with late stamps, too."""
    return _behind(bench, "late-udp", late, receive_own_messages=True)


def _behind(bench: Any, interface: str, late: str, **options: Any) -> Any:
    buses = {
        key: bus.model_copy(update={"interface": interface, "options": {"late": late, **options}})
        for key, bus in bench.buses.items()
    }
    return bench.model_copy(update={"buses": buses})
