"""What every device of a bench can do, whatever its make and wire, and what a look at it finds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, Protocol, runtime_checkable

import numpy as np
import numpy.typing as npt

from drivers.samples import SampleSource
from hil.core.can.signals import Payloads
from hil.core.controller import Controller
from hil.core.errors import HilError
from hil.core.vehicle import VehicleAndRoad

#: `fault`: a run cannot go well like this. `hint`: worth knowing, nothing fails for it.
Severity = Literal["fault", "hint"]


@dataclass(frozen=True)
class Finding:
    """Something that is wrong: what, where, and what to do about it."""

    severity: Severity
    what: str
    where: str
    fix: str = ""

    @classmethod
    def of(cls, error: HilError, where: str = "") -> Finding:
        """An error as a finding."""
        return cls("fault", error.what, error.where or where, error.fix)


@dataclass
class Examined:
    """How a device was found.

    Attributes:
        answers: whether it is there at all.
        facts: what it says of itself, by name: "state", "software", "rear left: vendor".
        findings: what is wrong.
        readings: what its sensors read now, by channel, in the channel's unit; those that it sends by itself
            need not be among them.
    """

    answers: bool = False
    facts: dict[str, str] = field(default_factory=dict)
    findings: list[Finding] = field(default_factory=list)
    readings: dict[str, float] = field(default_factory=dict)


@runtime_checkable
class Examinable(Protocol):
    """A device that can be looked at without changing anything: what `hil bench doctor` asks.

    A `Device` need not be one. It has been listened for some seconds before; `examine` may wait, by stepping
    the loop.
    """

    def examine(self, *, ask: bool) -> Examined:
        """Look at it. Reads, never writes.

        Args:
            ask: whether it may be sent anything at all; else only what came by itself counts.

        Raises:
            BenchError: its bus fails.
        """
        ...


@runtime_checkable
class Identifies(Protocol):
    """A device that says what it is: software, calibration, serial number. A `Device` need not be one."""

    def identify(self) -> dict[str, str]:
        """What it is, by name: "software", or "rear left: software" for a part of it.

        Asked before it comes up; reads only; may wait, by stepping the loop. What it does not say is left
        out.
        """
        ...


@runtime_checkable
class Incomplete(Protocol):
    """A device that comes up without parts that no run needs. A `Device` need not be one."""

    @property
    def missing(self) -> Sequence[str]:
        """Those parts, once it has come up."""
        ...


@runtime_checkable
class Device(Protocol):
    """A device on the bench. The engine knows no more of it than this.

    Nothing here is called from another thread, and only `come_up` may wait, by stepping the loop.
    """

    @property
    def name(self) -> str:
        """As people call it, for messages and events."""
        ...

    @property
    def sources(self) -> Sequence[SampleSource]:
        """What it measures; all of it is recorded and can be limited."""
        ...

    @property
    def heartbeat_s(self) -> float | None:
        """How often `beat` is called, seconds; None: it watches no one."""
        ...

    @property
    def safe_within_s(self) -> float:
        """How long it may take to become safe, seconds."""
        ...

    def come_up(self) -> None:
        """Find it, configure it, read back; it beats already.

        Raises:
            BenchError: it does not answer, or refuses.
        """
        ...

    def beat(self) -> None:
        """Tell it that the host lives."""
        ...

    def troubles(self) -> list[str]:
        """What is wrong with it now, a sentence each; asked several times a second while a run goes on."""
        ...

    def make_safe(self) -> None:
        """Tell it to go to its safe state; returns at once, and is repeated until `is_safe`."""
        ...

    def is_safe(self) -> bool:
        """Whether the device says that it is in its safe state, and says so now; old news is no news."""
        ...

    def close(self) -> None:
        """Let go of what it opened itself; the buses are closed by the bench."""
        ...


@runtime_checkable
class MotorControl(Device, Protocol):
    """What stands under [rmcu]: it makes the motor's torque from requests."""

    @property
    def state(self) -> str:
        """off, torque, driving_force, fault; empty before its first answer."""
        ...

    @property
    def fault(self) -> str:
        """Why it is in fault."""
        ...

    def requests(self, mode: str, values_nm: npt.NDArray[np.float64]) -> Payloads:
        """Payloads for samples of torque (N m), shape (n,), to be sent one each tick."""
        ...

    def send(self, payload: int) -> None:
        """Send one payload made by `requests`."""
        ...

    def send_ahead(self, payloads: Payloads, times_s: npt.NDArray[np.float64]) -> bool:
        """Hand over payloads made by `requests`, each with its time (s) on the bench clock, in order.

        False if its wire takes nothing ahead of time; then each is sent when its time has come.
        """
        ...

    def write_controller(self, controller: Controller) -> None:
        """Load a controller and read it back.

        Raises:
            BadInputError: it cannot take this controller.
            BenchError: it does not answer, or refuses.
        """
        ...


@runtime_checkable
class TakesBack(Protocol):
    """A `MotorControl` whose requests are counted, and that can take back those never sent."""

    def take_back(self, count: int) -> None:
        """The last `count` payloads made by `requests` will not be sent: the next go on from before them."""
        ...


@runtime_checkable
class SaysEmergency(Protocol):
    """A device that tells when somebody pressed its emergency stop."""

    @property
    def emergency(self) -> str:
        """What it answered; empty if no one did."""
        ...


@runtime_checkable
class SaysDamage(Protocol):
    """A device that knows which of its frames came damaged: what others do wrong may come of it."""

    @property
    def damage(self) -> str:
        """Bus, frames, and how many of how many; empty if none to speak of."""
        ...


@runtime_checkable
class SaysPowerless(Protocol):
    """A device that gives no torque once its host has left it, though it is not in its safe state then."""

    def is_powerless(self) -> bool:
        """Whether it says that it gives no torque, and says so now; asks it nothing."""
        ...


@runtime_checkable
class WheelLoad(Device, Protocol):
    """What stands under [dyno]: it turns the wheels, at a speed or like a vehicle."""

    @property
    def wheel_speed_rad_s(self) -> float:
        """Mean of both wheels, newest value."""
        ...

    def enable(self, acceleration_rad_s2: float) -> None:
        """Switch on, holding the present speed; ramps with this acceleration from now on.

        Raises:
            BenchError: it does not switch on.
        """
        ...

    def hold_speed(self, speed_rad_s: float) -> None:
        """Ramp both wheels to a speed (rad/s) and hold it there; returns at once."""
        ...

    def release_vehicle(self, initial_speed_m_s: float) -> None:
        """Simulate the vehicle from now on, starting at a speed in m/s."""
        ...


@runtime_checkable
class SetsVehicle(Protocol):
    """A device at which vehicle and road load can be set: a panel."""

    def set_vehicle(self, vehicle: VehicleAndRoad) -> Mapping[str, str]:
        """Write them and read them back; what it confirmed, by name, with units.

        Raises:
            BenchError: it does not take them.
        """
        ...


@runtime_checkable
class SetsSlip(Protocol):
    """A `WheelLoad` whose vehicle can slip. One need not be."""

    def set_slip(self, slip: float) -> None:
        """Have the vehicle slip by this share of its wheels' speed from now on, and read it back.

        Raises:
            BenchError: it does not take it.
        """
        ...
