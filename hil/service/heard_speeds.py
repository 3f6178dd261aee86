"""The speed of benches that are stopped and that no run of this service has seen to stand.

After a start of the service, or after a recording that ended while the axle turned: whoever resets the stop
should know whether it still does.
"""

from __future__ import annotations

import asyncio
import datetime
import logging
import time
from collections.abc import Callable

from hil.execution.benches import Bench
from hil.execution.motor_speed import hear_motor_speed
from hil.service.live.live_hub import last_speed
from hil.service.service import Service

_LOOK_S = 1.0
_TURNING_S = 5.0  # from one look to the next while the axle turns
_UNHEARD_S = 30.0  # and while nothing is heard

logger = logging.getLogger(__name__)


class HeardSpeeds:
    """Listens to the service's own benches while an emergency stop is latched, until the axle stands.

    The service's hub has the speeds that runs measured, and gets those that were heard.
    """

    def __init__(self, service: Service) -> None:
        self._service, self._hub = service, service.live_hub
        self._next_s: dict[str, float] = {}

    async def work(self, closing: Callable[[], bool]) -> None:
        """Listen where it is due, until the service is closed."""
        while not closing():
            for name in list(self._service.benches):
                bench = self._service.own(name)
                # a state is read from the disk, so it comes last
                measured = self._hub.measured_speed(name)
                stood = measured is not None and not measured.turns
                under_way = self._service.running(name) is not None
                if bench is None or stood or under_way or self._service.state(name)[0] != "emergency_stop":
                    self._next_s.pop(name, None)
                    self._hub.forget_heard(name)
                elif self._next_s.get(name, 0.0) <= time.monotonic():
                    self._next_s[name] = time.monotonic() + await self._listen(name, bench)
            await asyncio.sleep(_LOOK_S)

    async def _listen(self, name: str, bench: Bench) -> float:
        """Hear one bench; seconds until it is to be heard again."""
        try:
            heard = await hear_motor_speed(bench.file.source)
        except OSError as error:
            logger.warning("%s: its speed cannot be listened to: %s", name, error)
            return _UNHEARD_S
        if heard.speed_rad_s is None:
            self._hub.take_unheard(name, heard.why)
            return float("inf") if heard.final else _UNHEARD_S
        speed = last_speed(heard.speed_rad_s, datetime.datetime.now(datetime.UTC))
        self._hub.take_heard(name, speed)
        return _TURNING_S if speed.turns else float("inf")
