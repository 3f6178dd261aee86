"""What a look at a device tells: what it says of itself, what is wrong with it, and what to do."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal, Protocol, runtime_checkable

from hil.core.errors import HilError

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
