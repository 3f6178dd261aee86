"""What passes between the service and its stop post: lines of JSON over a pair of sockets."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

from hil.core.errors import StopWay


class _Data(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Owner(_Data):
    """Whose a token or a session is; `until_s`: of the epoch, None if it does not end."""

    name: str
    role: str
    until_s: float | None = None


# --- from the service ---


class OwnBench(_Data):
    """A bench file, and the folder of the service: there lie the stops of a bench that is simulated."""

    file: str
    stops: str = ""


class Benches(_Data):
    """The service's own benches by name; names of those of agents."""

    kind: Literal["benches"] = "benches"
    own: dict[str, OwnBench]
    others: list[str] = []


class Owners(_Data):
    """All valid tokens and sessions, by the SHA-256 of their secrets."""

    kind: Literal["owners"] = "owners"
    by_sha256: dict[str, Owner]


class Line(_Data):
    """A run's stop line: its descriptor comes with this message."""

    kind: Literal["line"] = "line"
    bench: str
    run: int
    folder: str


class Reset(_Data):
    """Somebody has let a bench be armed again."""

    kind: Literal["reset"] = "reset"
    bench: str


# --- from the stop post ---


class Up(_Data):
    """It answers from now on."""

    kind: Literal["up"] = "up"


class Stopped(_Data):
    """Somebody has asked for a stop, at `at_s` of the epoch.

    `run`: the run that was run; `latched`: it is on the disk; `problem`: why it is not.
    """

    kind: Literal["stopped"] = "stopped"
    bench: str
    by: str
    role: str
    origin: str
    way: StopWay
    at_s: float
    run: int | None
    latched: bool
    problem: str = ""


Message: TypeAlias = Benches | Owners | Line | Reset | Up | Stopped
_MESSAGES: TypeAdapter[Message] = TypeAdapter(Annotated[Message, Field(discriminator="kind")])


def to_line(message: Message) -> bytes:
    """The message as one line."""
    return message.model_dump_json().encode() + b"\n"


def from_line(line: bytes) -> Message:
    """The message of a line."""
    return _MESSAGES.validate_json(line)
