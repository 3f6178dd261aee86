"""The simulated bench behind adapters that stamp its frames late: in bursts, after pauses, one by one."""

from __future__ import annotations

from typing import Any

import can
import numpy as np
from can.interfaces import BACKENDS

from hil.core.frames import FrameBlock
from sim_backend.can_interface import SimulatedBus
from tests.benches_for_tests import sim_bench

BACKENDS["late-stamps"] = ("tests.late_stamps", "LateStamps")
_PAUSE_S = 0.05


class LateStamps(SimulatedBus):
    """A simulated bus whose frames come as ever but are stamped `late`.

    - "bursts": at the end of the 2 ms in which they came.
    - "pauses": now and then for 50 ms at the end of them, as if nobody had looked.
    - "outliers": now and then one by up to 50 ms.
    """

    def __init__(self, channel: str, late: str, **kwargs: Any) -> None:
        super().__init__(channel, **kwargs)
        self._late = late
        self._random = np.random.default_rng(len(channel))

    def recv_block(self) -> FrameBlock:
        """All frames that arrived until now."""
        block = super().recv_block().copy()
        stamps = block["time_s"]
        if self._late == "bursts":
            stamps = np.ceil(stamps / 0.002) * 0.002
        elif self._late == "pauses":
            begun = np.floor(stamps / 0.731) * 0.731  # a pause every 0.731 s
            stamps = np.maximum(stamps, np.where(stamps < begun + _PAUSE_S, begun + _PAUSE_S, 0.0))
        elif self._late == "outliers":
            hit = self._random.random(len(block)) < 2e-3
            stamps = stamps + hit * self._random.uniform(0.02, _PAUSE_S, len(block))
        block["time_s"] = stamps
        return block

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        raise NotImplementedError("frames are taken in blocks")


def late_bench(name: str, late: str, **changes: Any) -> Any:
    """The simulated bench behind such adapters."""
    bench = sim_bench(name, **changes)
    buses = {
        key: bus.model_copy(update={"interface": "late-stamps", "options": {"late": late}})
        for key, bus in bench.buses.items()
    }
    return bench.model_copy(update={"buses": buses})
