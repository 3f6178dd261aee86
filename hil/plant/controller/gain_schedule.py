"""Gains over the vehicle's speed: factors of a table, linear between its points."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

from hil.core.controller.bounds import MOST_SCHEDULE_POINTS
from hil.core.runtime.compiled import compiled
from hil.plant.controller import memory as M


class GainSchedule:
    """Factors of K_p and K_i together, and of K_i(DFC), at up to six speeds; no points: off."""

    def __init__(self, parameters: Mapping[str, float]) -> None:
        p = parameters
        self._points = round(p["schedule_points"])
        if not 0 <= self._points <= MOST_SCHEDULE_POINTS:
            raise ValueError("a schedule has too many points")
        places = range(MOST_SCHEDULE_POINTS)
        self._speeds = [p[f"schedule_speed_{place}"] for place in places]
        self._wsc = [p[f"schedule_wsc_{place}"] for place in places]
        self._dfc = [p[f"schedule_dfc_{place}"] for place in places]
        used = self._speeds[: self._points]
        if any(later <= earlier for earlier, later in pairwise(used)):
            raise ValueError("the speeds of a schedule do not rise")

    def load(self, memory: M.Memory) -> None:
        """Put the table into the firmware's memory."""
        memory.gains[M.SCHEDULE_POINTS] = self._points
        for first, values in (
            (M.SCHEDULE_SPEED, self._speeds),
            (M.WSC_FACTOR, self._wsc),
            (M.DFC_FACTOR, self._dfc),
        ):
            memory.gains[first : first + MOST_SCHEDULE_POINTS] = values


@compiled
def factor(k, first, v_hat):  # type: ignore[no-untyped-def]
    """From the table whose factors begin at gain `first`, for a speed in m/s; 1 without a table."""
    points = int(k[M.SCHEDULE_POINTS])
    if points == 0:
        return 1.0
    speed = abs(v_hat)
    if speed <= k[M.SCHEDULE_SPEED]:
        return k[first]
    for i in range(1, points):
        after = k[M.SCHEDULE_SPEED + i]
        if speed < after:
            before = k[M.SCHEDULE_SPEED + i - 1]
            share = (speed - before) / (after - before)
            return k[first + i - 1] + share * (k[first + i] - k[first + i - 1])
    return k[first + points - 1]
