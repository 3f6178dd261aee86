"""What passes between the command and the process that holds the hardware, as lines of JSON.

Nothing in a line can be run: plan, bench and model pass as the texts of their files and are read again.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any, Literal, Self, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from hil.core.errors import (
    BadInputError,
    BenchError,
    EmergencyStopError,
    HilError,
    InterruptError,
    OrderlyEndError,
    StopWay,
)
from hil.core.result import RunResult

_KINDS: dict[str, type[HilError]] = {
    kind.__name__: kind
    for kind in (HilError, BadInputError, BenchError, OrderlyEndError, EmergencyStopError, InterruptError)
}


_WAYS: dict[StopWay, str] = {"api": " over the service's API", "page": " on the service's page"}


class _Data(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class ErrorData(_Data):
    """An error as it passes; `by`, `origin`, `way`: who asked for an emergency stop, from where, how."""

    kind: str
    what: str
    where: str = ""
    fix: str = ""
    by: str = ""
    origin: str = ""
    way: StopWay = ""

    @classmethod
    def of(cls, error: HilError) -> Self:
        """What passes of an error; of a kind that is not known here, as the nearest that is."""
        kind = next(kind.__name__ for kind in type(error).__mro__ if kind.__name__ in _KINDS)
        stop = {name: getattr(error, name) for name in ("by", "origin", "way") if hasattr(error, name)}
        return cls(kind=kind, what=error.what, where=error.where, fix=error.fix, **stop)

    def as_error(self) -> HilError:
        """The error again."""
        kind = _KINDS.get(self.kind, BenchError)
        if kind is EmergencyStopError:
            return EmergencyStopError(
                self.what, by=self.by, origin=self.origin, way=self.way, where=self.where, fix=self.fix
            )
        return kind(self.what, where=self.where, fix=self.fix)


# --- from the command ---


class RunAsked(_Data):
    """The run to be executed; the fields are those of `RunRequest`, files as their texts."""

    kind: Literal["run"] = "run"
    plan: str
    plan_source: str
    bench: str
    bench_source: str
    out: str
    model: str | None = None
    operator: str = ""
    operator_is_there: bool = False
    confirmed_by: str = ""
    hazard_confirmed_by: str = ""
    accept_expired: str = ""
    replaces: tuple[str, ...] = ()
    stops: str = ""


class Here(_Data):
    """The command is still there."""

    kind: Literal["here"] = "here"


class StopAsked(_Data):
    """Somebody has asked to stop, so often until now."""

    kind: Literal["stop"] = "stop"
    times: int


class Typed(_Data):
    """A line that the operator typed."""

    kind: Literal["typed"] = "typed"
    line: str


class EmergencyAsked(_Data):
    """An emergency stop that did not come from this run's terminal: by whom, from which address, how."""

    kind: Literal["emergency"] = "emergency"
    by: str
    origin: str = ""
    way: StopWay = "api"

    def as_error(self) -> EmergencyStopError:
        """What ends the run."""
        place = f" from {self.origin}" if self.origin and self.origin not in self.by else ""
        how = _WAYS.get(self.way, "")
        return EmergencyStopError(
            f"requested by {self.by}{place}{how}", by=self.by, origin=self.origin, way=self.way
        )


# --- from the process that holds the hardware ---


class Turned(_Data):
    """The loop has turned; the first says that devices hear their host from now on."""

    kind: Literal["turned"] = "turned"


class Progressed(_Data):
    """The share that is done, and what is going on."""

    kind: Literal["progress"] = "progress"
    share: float
    text: str


class Question(_Data):
    """What the operator is asked; `picture`: a file beside the plan, '' for none."""

    text: str
    answer_within_s: float
    picture: str = ""


class OperatorText(_Data):
    """A text for the operator; with `question` an answer is awaited."""

    kind: Literal["message"] = "message"
    text: str
    question: Question | None = None


class Logged(_Data):
    """A line of the log; `traceback` of a mistake in the program."""

    kind: Literal["logged"] = "logged"
    logger: str
    level: int
    text: str
    traceback: str = ""


class Concluded(_Data):
    """The loop has done its part: the bench is safe, or the complaints of those that did not confirm it."""

    kind: Literal["concluded"] = "concluded"
    armed: bool
    unsafe: tuple[str, ...] = ()


class Refused(_Data):
    """There was no run."""

    kind: Literal["refused"] = "refused"
    error: ErrorData


class Ended(_Data):
    """How the run ended; the fields are those of `RunOutcome`."""

    kind: Literal["ended"] = "ended"
    result: RunResult
    recording: str
    error: ErrorData | None = None
    largest: dict[str, float] = {}
    made: tuple[str, ...] = ()


Message: TypeAlias = (
    RunAsked
    | Here
    | StopAsked
    | Typed
    | EmergencyAsked
    | Turned
    | Progressed
    | OperatorText
    | Logged
    | Concluded
    | Refused
    | Ended
)
_MESSAGES: TypeAdapter[Message] = TypeAdapter(Annotated[Message, Field(discriminator="kind")])


def to_line(message: Message) -> bytes:
    """The message as one line of ASCII, its end included; also texts that are no Unicode, and NaN."""
    return json.dumps(message.model_dump(mode="python"), default=_plain).encode("ascii") + b"\n"


def from_line(line: bytes) -> Message:
    """The message of a line.

    Raises:
        BenchError: it is none.
    """
    try:
        return _MESSAGES.validate_python(json.loads(line))
    except (ValueError, ValidationError) as error:
        what = f"a message between the processes of a run cannot be understood: {str(error)[:200]}"
        raise BenchError(what, where="ipc", fix="please report it") from error


def _plain(value: Any) -> Any:
    if isinstance(value, Path):
        return str(value)
    raise TypeError(f"{type(value).__name__} does not pass")
