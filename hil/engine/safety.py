"""The way to the safe state: every device at once, each with a deadline, each read back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from drivers import TICK_S
from hil.core.errors import HilError
from hil.engine.bench import Bench

_REPEAT_S = 0.01


@dataclass
class Device:
    """A device on its way to safety: `command` is repeated until `is_safe` or the deadline."""

    name: str
    command: Callable[[], None]
    is_safe: Callable[[], bool]
    deadline_s: float
    failure: str = ""

    def try_command(self) -> None:
        """Command; a failure is kept, not raised: the other devices still need their turn."""
        try:
            self.command()
        except HilError as error:
            self.failure = error.what

    def complaint(self) -> str:
        """What to tell when it did not become safe."""
        reason = f": {self.failure}" if self.failure else ""
        return f"{self.name} did not confirm its safe state within {self.deadline_s:g} s{reason}"


def devices_of(bench: Bench) -> list[Device]:
    """The devices that can put torque on the axle."""
    return [
        Device("RMCU", bench.rmcu.request_off, bench.rmcu.is_off, 0.5),
        Device("dynos", bench.dyno.disable, bench.dyno.is_off, 0.5),
    ]


def reach_safe_state(bench: Bench) -> list[str]:
    """Bring all devices to no torque; the complaints of those that did not confirm it in time.

    Never raises for a device or a bus that fails: it goes on with the others.
    """
    bench.loop.shielded = True
    devices = devices_of(bench)
    start_s = bench.loop.clock.now_s()
    waiting = list(devices)
    tick = 0
    while waiting:
        if tick % round(_REPEAT_S / TICK_S) == 0:
            for device in waiting:
                device.try_command()
        try:
            bench.loop.wait_for(lambda: False, TICK_S)
        except HilError:
            # A dead bus must not keep the others from being served; time still has to pass.
            bench.loop.clock.sleep_until(bench.loop.clock.now_s() + TICK_S)
        tick += 1
        passed_s = bench.loop.clock.now_s() - start_s
        waiting = [d for d in waiting if not d.is_safe() and passed_s < d.deadline_s]
    return [d.complaint() for d in devices if not d.is_safe()]
