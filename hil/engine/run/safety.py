"""The way to the safe state: every device at once, each with a deadline, each read back."""

from __future__ import annotations

import contextlib
from collections.abc import Callable

from drivers import TICK_S, Device
from hil.core.errors import HilError
from hil.engine.bench.bench import Bench

_REPEAT_S = 0.01

Fault = Callable[[Exception], None]


class _Descent:
    """A device on its way to safety: asked again and again until it is there or its deadline has passed."""

    def __init__(self, device: Device, fault: Fault) -> None:
        self._device, self._fault = device, fault
        self.deadline_s = device.safe_within_s
        self.failure = ""

    def make_safe(self) -> None:
        """Tell it; a failure is kept, not raised: the other devices still need their turn."""
        try:
            self._device.make_safe()
        except HilError as error:
            self.failure = error.what
        except Exception as error:  # a fault in a device's code
            self._keep(error)

    def is_safe(self) -> bool:
        """Whether it is there."""
        try:
            return self._device.is_safe()
        except Exception as error:  # a fault in a device's code: then nothing is known
            self._keep(error)
            return False

    def complaint(self) -> str:
        """What to tell when it did not become safe."""
        reason = f": {self.failure}" if self.failure else ""
        return f"{self._device.name} did not confirm its safe state within {self.deadline_s:g} s{reason}"

    def _keep(self, error: Exception) -> None:
        if not self.failure:
            self.failure = f"{type(error).__name__}: {error}"
            self._fault(error)


def reach_safe_state(bench: Bench, fault: Fault = lambda error: None) -> list[str]:
    """Bring all devices to their safe state; the complaints of those that did not confirm it in time.

    Never raises for a device or a bus that fails: it goes on with the others. `fault` gets what is a
    mistake in a device's code.
    """
    bench.loop.shielded = True
    descents = [_Descent(device, fault) for device in bench.devices]
    start_s = bench.loop.clock.now_s()
    waiting = list(descents)
    tick, reported = 0, False
    while waiting:
        if tick % round(_REPEAT_S / TICK_S) == 0:
            for descent in waiting:
                descent.make_safe()
        try:
            bench.loop.wait_for(lambda: False, TICK_S)
        except Exception as error:
            if not isinstance(error, HilError) and not reported:
                reported = True
                fault(error)
            # Neither a dead bus nor a faulty device may keep the others from being served.
            bench.loop.clock.sleep_until(bench.loop.clock.now_s() + TICK_S)
            with contextlib.suppress(Exception):
                bench.loop.drain()
        tick += 1
        passed_s = bench.loop.clock.now_s() - start_s
        waiting = [d for d in waiting if not d.is_safe() and passed_s < d.deadline_s]
    return [d.complaint() for d in descents if not d.is_safe()]
