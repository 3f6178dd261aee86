"""Carries a run out, from its claim to its end, for the owner of its bench: the service, or an agent."""

from __future__ import annotations

import contextlib
import datetime
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, Protocol

from hil.api_schemas.agent import TakenRun
from hil.api_schemas.api import PromptData, RunData
from hil.core.errors import BenchError, EmergencyStopError, HilError
from hil.core.files import make_directory, write_atomically
from hil.core.result import RunResult
from hil.engine import RECORDING
from hil.engine.ipc.ipc_messages import EmergencyAsked, OperatorText, Progressed, Question, Refused, RunAsked
from hil.engine.run.operator import GONE_REASON
from hil.execution.benches import Bench
from hil.execution.run_process import RunProcess, result_in

PLAN = "plan.yaml"
STOPPED_BEFORE = "stopped before it began"
_NOTHING = "the {who} ended before the recording started; the run can be queued again"
_KEPT = "the {who} ended during the run; data measured before that is kept"


class Steered(Protocol):
    """A run under way, as those see it who may steer it."""

    def pause(self) -> None:
        """Hold it at its next safe point."""

    def resume(self) -> None:
        """Let it go on."""

    def end(self) -> None:
        """End it, with its end steps."""

    def stop_in_emergency(self, asked: EmergencyAsked) -> None:
        """Have the bench safe at once."""

    def answer(self, text: str) -> None:
        """A line for the operator's prompt."""


@dataclass
class RunningRun:
    """A run under way. `message`: the last text for its operator; `prompt`: a question that is open.

    `ending`: somebody has asked for its end, which its end steps may delay.
    """

    data: RunData
    folder: Path
    process: Steered
    share: float | None = None
    doing: str = "beginning"
    message: str = ""
    prompt: PromptData | None = None
    ending: bool = False

    @property
    def shown(self) -> str:
        """What it does, for people."""
        return f"being ended: {self.doing}" if self.ending else self.doing


@dataclass(frozen=True)
class RunEnd:
    """How a run ended, and when if not just now; `queued` if another program was quicker: it waits again."""

    state: Literal["ended", "interrupted", "queued"]
    exit_code: int | None = None
    result: RunResult | None = None
    reason: str = ""
    dut: str = ""
    at: datetime.datetime | None = None


class RunExecution(RunningRun):
    """A run of which the process is here."""

    process: RunProcess

    @classmethod
    async def begin(
        cls,
        taken: TakenRun,
        bench: Bench,
        folder: Path,
        stop_line: int | None = None,
    ) -> RunExecution:
        """Start its process.

        Args:
            folder: for what the run leaves; made.
            stop_line: a descriptor from which it takes emergency stops, too.

        Raises:
            HilError, OSError: the bench's file cannot be used any more, the folder cannot be written.
        """
        make_directory(folder)
        write_atomically(folder / PLAN, taken.plan_text)
        process = await RunProcess.begin(_request_of(taken, bench, folder), stop_line)
        run = cls(taken.data, folder, process)
        process.answered = run._asks_no_more
        return run

    async def ended(self, bench: Bench, changed: Callable[[], None], closing: Callable[[], bool]) -> RunEnd:
        """Listen to it until it has ended; how it did.

        Args:
            changed: called when something is to be shown anew.
            closing: whether who drives the bench has ended the run for its own end.
        """
        refused: HilError | None = None
        async for message in self.process.messages():
            if isinstance(message, Progressed):
                self.share = message.share if message.share >= 0 else self.share
                self.doing = message.text
            elif isinstance(message, OperatorText):
                self.message = message.text
                self.prompt = _asked(message.question) or self.prompt
            elif isinstance(message, Refused):
                refused = message.error.as_error()
            changed()
        code = await self.process.exit_code()
        result, recorded = result_in(self.folder), (self.folder / RECORDING).exists()
        if refused is not None and not recorded and not closing():
            if isinstance(refused, EmergencyStopError) or (
                isinstance(refused, BenchError) and bench.stopped()
            ):
                return RunEnd("ended", code, reason=_stopped_before(refused), dut=bench.dut)
            if bench.used_by():  # another program was quicker
                return RunEnd("queued", reason=str(refused))
        reason = "" if result is not None else str(refused or f"its process ended with code {code}")
        if result is None and recorded:
            reason += f"\n  hil evidence recover {self.folder} recovers the recording of what was measured"
        return RunEnd("interrupted" if closing() else "ended", code, result, reason, bench.dut)

    def _asks_no_more(self) -> None:
        self.message, self.prompt = "", None


def _stopped_before(refused: HilError) -> str:
    """Why a run is over of which the bench was stopped after it was taken and before it measured anything.

    It does not wait for the reset: nothing may move by itself because somebody has reset a stop.
    """
    fix = f"\n  {refused.fix}" if refused.fix else ""
    return f"{STOPPED_BEFORE}: {refused.what}{fix}"


def _asked(question: Question | None) -> PromptData | None:
    if question is None:
        return None
    until = datetime.datetime.now(datetime.UTC) + datetime.timedelta(seconds=question.answer_within_s)
    return PromptData(text=question.text, answer_by=until, picture=question.picture)


def end_of_left(folder: Path, who: str, bench: Bench | None) -> RunEnd:
    """How a run ended whose service or agent (`who`) was killed; its process has ended.

    Args:
        bench: of the run, for the device that it had; None if that is not known here any more.
    """
    result = result_in(folder)
    reason = (_KEPT if (folder / RECORDING).exists() else _NOTHING).format(who=who)
    if result is not None and result.reason not in ("", GONE_REASON):
        reason += f": {result.reason}"
    dut = bench.dut if bench is not None else ""
    return RunEnd("interrupted", result=result, reason=reason, dut=dut, at=_last_written(folder))


def _last_written(folder: Path) -> datetime.datetime | None:
    """When something was last written to a run's folder; None if nothing was."""
    found: list[float] = []
    with contextlib.suppress(OSError):  # a file that is removed at this moment
        found += [path.stat().st_mtime for path in folder.rglob("*") if path.is_file()]
    return datetime.datetime.fromtimestamp(max(found), datetime.UTC) if found else None


def _request_of(taken: TakenRun, bench: Bench, folder: Path) -> RunAsked:
    """What the process of a run gets to know.

    Raises:
        BadInputError: the bench's file cannot be used any more.
    """
    run, file = taken.data, bench.read_again()
    return RunAsked(
        plan=taken.plan_text,
        plan_source=taken.plan_source,
        bench=file.text,
        bench_source=str(file.source),
        out=str(folder),
        operator=run.requested_by,
        operator_is_there=True,
        confirmed_by=taken.confirmed_by,
        hazard_confirmed_by=_takes_it_upon_them(run),
        accept_expired=taken.accept_expired,
        stops=str(bench.stops or ""),
    )


def _takes_it_upon_them(run: RunData) -> str:
    if not run.hazard:
        return ""
    return f"{run.requested_by}, approved by {run.approved_by}" if run.approved_by else run.requested_by
