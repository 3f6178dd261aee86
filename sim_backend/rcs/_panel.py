"""The RC-S's panel, emulated: AK-style telegrams on a pseudo-terminal."""

from __future__ import annotations

import os
import pty
import select
import tty
from collections.abc import Callable

from hil.core.ak import BUSY, DATA, OFFLINE, SYNTAX, UNKNOWN, Answer, Request, Telegrams, request_of
from hil.core.vehicle import VehicleAndRoad

#: By code to write: code to read, largest value, field of `VehicleAndRoad`, its units in one of the panel's.
_SETTINGS = {
    "EMAS": ("AMAS", 10_000.0, "mass_kg", 1.0),
    "EFW0": ("AFW0", 10_000.0, "f0_n", 1.0),
    "EFW1": ("AFW1", 1_000.0, "f1_ns_m", 1.0),
    "EFW2": ("AFW2", 100.0, "f2_ns2_m2", 1.0),
    "ESLP": ("ASLP", 50.0, "slip", 0.01),
    "EMUL": ("AMUL", 10.0, "friction_left", 1.0),
    "EMUR": ("AMUR", 10.0, "friction_right", 1.0),
}
_FRICTION = ("EMUL", "EMUR")
_LATE_TICKS, _LOOK_TICKS, _LOOK_S = 60, 10, 0.25
_READ = {read: write for write, (read, *_) in _SETTINGS.items()}


class EmulatedPanel:
    """What the panel answers; `taken` is called with each value that somebody wrote.

    Without `friction` its vehicle has tyres that hold whatever the road is, and it refuses a friction.
    """

    def __init__(
        self, taken: Callable[[VehicleAndRoad], None] = lambda vehicle: None, *, friction: bool = True
    ) -> None:
        self.remote = False
        self.alarms: list[str] = []
        self.latched: list[str] = []  # alarms that a reset does not clear
        self.busy = 0  # so many requests are answered by "busy"
        self.values = {code: 1.0 if code in _FRICTION else 0.0 for code in _SETTINGS}
        self._has_friction = friction
        self._taken = taken
        self._telegrams = Telegrams()

    def hear(self, data: bytes) -> bytes:
        """What it says to bytes that came."""
        return b"".join(self._answer(request_of(text)).telegram() for text in self._telegrams.feed(data))

    def _answer(self, request: Request | None) -> Answer:
        if request is None:
            return Answer(UNKNOWN, 1, (SYNTAX,))
        if self.busy:
            self.busy -= 1
            return Answer(request.function, 1, (BUSY,))
        return self._carried_out(request)

    def _carried_out(self, request: Request) -> Answer:
        function = request.function
        if function == "ASTZ":
            return Answer(function, 0, ("SREM" if self.remote else "SMAN",))
        if function == "ASTF":
            return Answer(function, 0, (*self.latched, *self.alarms) or ("0",))
        if function in _READ:
            return Answer(function, 0, (f"{self.values[_READ[function]]:g}",))
        if function == "SREM":
            self.remote = True
            return Answer(function)
        if function not in ("SMAN", "SRES", *_SETTINGS):
            return Answer(UNKNOWN, 1, (SYNTAX,))
        if not self.remote:
            return Answer(function, 1, (OFFLINE,))
        if function == "SMAN":
            self.remote = False
        elif function == "SRES":
            self.alarms.clear()
        else:
            return self._set(function, request.data)
        return Answer(function)

    def _set(self, function: str, data: tuple[str, ...]) -> Answer:
        _, largest, key, unit = _SETTINGS[function]
        try:
            (text,) = data
            value = float(text)
        except ValueError:
            return Answer(function, 1, (SYNTAX,))
        least = 1e-3 if function in _FRICTION else 0.0
        if not least <= value <= largest or (function in _FRICTION and not self._has_friction):
            return Answer(function, 1, (DATA,))
        self.values[function] = value
        self._taken(VehicleAndRoad(**{key: value * unit}))
        return Answer(function)


class PanelPort:
    """The panel at the other end of a pseudo-terminal; `tick` is to be called a hundred times a second.

    Args:
        waits: until the terminal has passed an answer on: for hosts whose time is computed.
    """

    def __init__(self, panel: EmulatedPanel, *, waits: bool = True) -> None:
        self.panel, self._waits, self._quiet = panel, waits, _LATE_TICKS
        self._own, self._theirs = pty.openpty()
        tty.setraw(self._theirs)
        os.set_blocking(self._own, False)
        self.port = os.ttyname(self._theirs)

    def tick(self) -> None:
        """Answer what came."""
        self._quiet += 1
        if self._waits and self._quiet > _LATE_TICKS and self._quiet % _LOOK_TICKS == 0:
            # Asked twice a second: the terminal may be behind computed time
            select.select([self._own], [], [], _LOOK_S)
        try:
            answer = self.panel.hear(os.read(self._own, 4096))
        except BlockingIOError:
            return
        self._quiet = 0
        if answer:
            os.write(self._own, answer)
        if answer and self._waits:
            select.select([self._theirs], [], [], 1.0)  # computed time is fast: let the terminal pass it on

    def close(self) -> None:
        """Let go of the terminal."""
        os.close(self._own)
        os.close(self._theirs)
