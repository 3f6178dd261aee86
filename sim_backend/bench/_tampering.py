"""Somebody between the nodes of a simulated bench and its hosts, who also reads the plant's own log."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Protocol

import numpy as np
import numpy.typing as npt

from hil.core.can.frames import FrameBlock


class Tamper(Protocol):
    """Loses, changes, delays and invents frames; breaks what it likes."""

    def time_passes(self, now_s: float) -> None:
        """The bench's time is `now_s`."""
        ...

    def to_hosts(self, bus: str, block: FrameBlock) -> FrameBlock:
        """What hosts get in place of the frames that nodes have sent since they last looked."""
        ...

    def to_nodes(self, bus: str, frame_id: int, data: bytes) -> Iterable[tuple[int, bytes]]:
        """What nodes get in place of a frame of a host; raises what an adapter would raise."""
        ...

    def look(self, first: int, rows: npt.NDArray[np.float64]) -> None:
        """Samples of the plant, from number `first` on: rows of `hil.plant.closed_loop.tick`."""
        ...
