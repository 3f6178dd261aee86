"""What passes between who asks for a run and who holds the hardware: data, and calls that carry data.

On one side stand engine, drivers and recorder, on the other command, analysis and reports: on hardware in two
processes (docs/decisions/0011 and 0017).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

from hil.core.errors import HilError
from hil.core.model import Model
from hil.core.recording import Recording
from hil.core.result import RunResult
from hil.core.runtime.other_process import OtherProcess
from hil.engine.bench.bench_tables import BenchFile
from hil.engine.ipc.ipc_messages import EmergencyAsked, Question
from hil.engine.stop.stopping import StopRequest
from test_plans import Plan, Work

RECORDING = "recording.mcap"

Progress = Callable[[float, str], None]


class Analysis(Protocol):
    """An analysis that is being done."""

    def done(self) -> bool:
        """Whether it has ended; never waits."""
        ...

    def result(self) -> Mapping[str, bytes]:
        """Files by name; raises what went wrong."""
        ...

    def kill(self) -> None:
        """No one wants it any more."""
        ...


Analyse = Callable[[Work, Recording, Path], Analysis]


@dataclass(frozen=True)
class Analysed:
    """An analysis that has been done already."""

    files: Mapping[str, bytes]

    def done(self) -> bool:
        """It has."""
        return True

    def result(self) -> Mapping[str, bytes]:
        """Files by name."""
        return self.files

    def kill(self) -> None:
        """Too late."""


class Terminal(Protocol):
    """The operator's terminal. Nothing here waits."""

    def tell(self, text: str, question: Question | None = None) -> None:
        """Show a text; with `question` an answer is awaited."""
        ...

    def typed(self) -> Sequence[str | EmergencyAsked]:
        """Lines that were typed since the last call, and emergency stops that others asked for."""
        ...


class Watched(Protocol):
    """Who watches from another process that the loop turns. Nothing here waits."""

    def turned(self) -> str:
        """The loop has turned once more; says why no one watches any more, '' if somebody does."""
        ...

    def concluded(self, *, armed: bool, unsafe: Sequence[str]) -> None:
        """The loop has done its part; `unsafe`: complaints of those that did not confirm their safe state."""
        ...


def analysed_here(work: Work, recording: Recording, directory: Path) -> Analysis:
    """Do the analysis where it is asked for: where time stands still meanwhile."""
    return Analysed(work(recording, directory))


def analysed_apart(work: Work, recording: Recording, directory: Path) -> Analysis:
    """Let a process of its own do it: heartbeats go on, and it can be killed."""
    return OtherProcess(work, recording, directory)


@dataclass
class RunOutcome:
    """How a run ended: data.

    `error` is what stopped it, if anything; `made` are files of its analysis steps.
    """

    result: RunResult
    recording: Path
    error: HilError | None
    largest: dict[str, float]
    made: tuple[str, ...] = ()


@dataclass
class RunRequest:
    """A run to be executed.

    Data: `plan`, `bench`, `out`, `model`, `operator`, `confirmed_by` (who confirmed every prompt beforehand),
    `hazard_confirmed_by` (who takes a hazardous plan upon them), `accept_expired` ("NAME: reason" of who
    answers for sensors whose calibration has run out) and `replaces`: files of an earlier run in the same
    place, which are removed once nothing about plan and bench can keep this run from beginning.

    Calls to who asked for the run, with data and for data: `terminal` shows texts to the operator and gives
    what was typed (None: no one can be asked); `progress` gets the share that is done and what is going
    on; `analyse` begins the analysis of a step of the plan, while the bench is kept alive (None: in a process
    of its own on hardware, at once in virtual time).

    `stops` is the folder of the service or agent that asks, where stops of a simulated bench are kept (None:
    they end with the process).

    `watched` hears that the loop turns, if another process watches it.

    The one call the other way is `stop`.
    """

    plan: Plan
    bench: BenchFile
    out: Path
    model: Model | None = None
    operator: str = ""
    terminal: Terminal | None = None
    confirmed_by: str = ""
    hazard_confirmed_by: str = ""
    accept_expired: str = ""
    progress: Progress = lambda share, text: None
    analyse: Analyse | None = None
    replaces: tuple[Path, ...] = ()
    stops: Path | None = None
    watched: Watched | None = None
    stop: StopRequest = field(default_factory=StopRequest)
