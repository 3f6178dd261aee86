"""What can go wrong, in the words of the person who has to act on it."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

#: By which way an emergency stop came: a key at the terminal of `hil run`, a request to the API or from the
#: page, a device of the bench (its button, an EMCY), an interlock; '' of recordings that do not say it.
StopWay = Literal["", "terminal", "api", "page", "device", "interlock"]


class HilError(Exception):
    """An error that tells what happened, where, and what to do about it.

    `exit_code` is the process exit code of docs/reference/commands.md.
    """

    exit_code: ClassVar[int] = 3

    def __init__(self, what: str, *, where: str = "", fix: str = "") -> None:
        self.what = what
        self.where = where
        self.fix = fix
        super().__init__(what)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pass between processes as it is, whatever arguments a subclass is made with."""
        return _as_it_was, (type(self), self.args, self.__dict__)

    def __str__(self) -> str:
        text = f"{self.where}: {self.what}" if self.where else self.what
        return f"{text}\n  {self.fix}" if self.fix else text


def _as_it_was(kind: type[HilError], arguments: tuple[object, ...], state: dict[str, Any]) -> HilError:
    error = kind.__new__(kind, *arguments)
    error.__dict__.update(state)
    return error


class BadInputError(HilError):
    """A file, a key or an argument that cannot be used (exit code 2)."""

    exit_code = 2


class BenchError(HilError):
    """The bench or the service failed (exit code 3)."""

    exit_code = 3


class DeviceError(BenchError):
    """A device does not answer, or refuses what it is asked (exit code 3).

    Who may do without an answer ignores this and nothing wider: while a device is read, a limit may trip, an
    operator may stop, and the command may be gone, and each of them is a `BenchError` too.
    """


class LimitTripError(BenchError):
    """A measured value went beyond a limit of the bench (exit code 3, unless it was the device's doing)."""


class OrderlyEndError(BenchError):
    """The run was ended though every device is well: its end steps can be executed (exit code 3)."""


class EmergencyStopError(BenchError):
    """An emergency stop: nothing moves any more until a person has reset it (exit code 3).

    `by`: who or what asked for it; `origin`: the address or device that it came from; `way`: how.
    """

    def __init__(
        self,
        what: str,
        *,
        by: str,
        origin: str = "",
        way: StopWay = "",
        where: str = "emergency stop",
        fix: str = "",
    ) -> None:
        super().__init__(what, where=where, fix=fix)
        self.by, self.origin = by, origin
        self.way: StopWay = way


class InterruptError(HilError):
    """The operator stopped the run (exit code 130)."""

    exit_code = 130
