"""What stopped a run: kept once, and reported in its recording."""

from __future__ import annotations

import contextlib
import traceback
from collections.abc import Callable

from hil.core.errors import BenchError, EmergencyStopError, HilError, InterruptError


class Failures:
    """Keeps what stopped a run: the first failure, or the emergency stop that came after it.

    Args:
        event: takes an event of the recording; a disk that is full is no news here.
        blame: what to say of a failure whose cause may be that the loop itself stood still; '' if it is not.
    """

    def __init__(self, event: Callable[[str, str], None], blame: Callable[[], str]) -> None:
        self._event, self._blame = event, blame
        self.error: HilError | None = None

    def take(self, error: Exception) -> None:
        """Something went wrong; what is not an error of ours is a mistake in the program."""
        if not isinstance(error, HilError):
            self.note(error)
            error = BenchError(f"internal error: {type(error).__name__}: {error}", fix="please report it")
        if self.error is not None and not isinstance(error, EmergencyStopError):
            return
        self.error = self._with_blame(error)
        self.tell(_kind_of(error), str(self.error).replace("\n", " "))

    def note(self, error: Exception) -> None:
        """A fault of ours, or of a device's code: where it happened stands in the recording."""
        self.tell("traceback", "".join(traceback.format_exception(error)))

    def tell(self, kind: str, text: str) -> None:
        """Record an event, if the recording still takes any."""
        with contextlib.suppress(Exception):  # that it takes none is already being reported
            self._event(kind, text)

    def _with_blame(self, error: HilError) -> HilError:
        if type(error) is not BenchError or "the bench loop was delayed" in error.what:
            return error
        pause = self._blame()
        return BenchError(f"{error.what} ({pause})", where=error.where, fix=error.fix) if pause else error


def _kind_of(error: HilError) -> str:
    if isinstance(error, EmergencyStopError):
        return "emergency_stop"
    return "interrupt" if isinstance(error, InterruptError) else "failure"
