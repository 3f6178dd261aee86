"""The process that holds the hardware: one run, requested and reported over pipes.

Whether a process is about to be no more, before its pipes say so.

They close once the system has taken its memory apart: 10 to 80 ms for the 200 MB of a command on a busy
machine, in which a bench would be driven for no one.
"""

from __future__ import annotations

import logging
import os
import time
import traceback
from collections.abc import Sequence
from pathlib import Path

from hil.core.channels import PACKAGES
from hil.core.errors import BenchError, HilError
from hil.engine.ipc.ipc import analysed_apart
from hil.engine.ipc.ipc_data import ended_of, request_of
from hil.engine.ipc.ipc_messages import (
    Concluded,
    EmergencyAsked,
    ErrorData,
    Logged,
    Message,
    OperatorText,
    Progressed,
    Question,
    Refused,
    RunAsked,
    StopAsked,
    Turned,
    Typed,
)
from hil.engine.ipc.ipc_pipe import IpcPipe
from hil.engine.run.run import run_plan
from hil.engine.stop.stopping import StopRequest, hear_signals

_ENDED = (b"Z", b"X", b"x")
_EXITING = 0x4  # PF_EXITING of the kernel's include/linux/sched.h
_KILLED = 1 << (9 - 1)  # SIGKILL awaits it
# Of /proc/PID/stat from the state on, after a name that may have spaces and parentheses: proc_pid_stat(5)
_STATE, _FLAGS, _PENDING = 0, 6, 28


def is_ending(process: int) -> bool:
    """Whether a process has been killed, is ending, or has ended and no one has asked how.

    Takes some 30 microseconds. False where the system does not tell (not Linux), and of a process of which
    nothing is left: its pipes have closed by then.
    """
    try:
        with Path(f"/proc/{process}/stat").open("rb", buffering=0) as file:
            fields = file.read(1024).rpartition(b")")[2].split()
    except OSError:
        return False
    if len(fields) <= _PENDING:
        return False
    going = int(fields[_FLAGS]) & _EXITING or int(fields[_PENDING]) & _KILLED
    return fields[_STATE] in _ENDED or bool(going)


ASKED_WITHIN_S = 60.0
#: How long its last words may wait for a command that does not read, s.
LAST_WORDS_S = 10.0

logger = logging.getLogger(__name__)


def hold_hardware(pipe: IpcPipe) -> str:
    """Execute the run that is asked for at the other end; what no one there has heard of how it ended.

    Asking to stop counts as often as signals came here or the command tells of, whichever is more: a terminal
    or a service manager may tell both.
    """
    stop = StopRequest()
    with stop.by_signals():
        hear_signals()
        _log_to(pipe)
        command = _Command(pipe, stop)
        asked = command.asked()
        if asked is None:
            return ""
        words = "there was no run"
        try:
            request = request_of(asked)
            request.stop, request.watched = stop, command
            request.terminal = command if asked.operator_is_there else None
            request.progress, request.analyse = command.progress, analysed_apart
            command.alone_after_s = request.bench.supervision.alone_after_s / request.bench.time_scale
            outcome = run_plan(request)
            words = f"{outcome.error or 'the run is over'}\nsafe state {outcome.result.safe_state}"
            pipe.send(ended_of(outcome))
        except HilError as error:
            pipe.send(Refused(error=ErrorData.of(error)))
        except Exception as error:
            logger.exception("internal error")
            pipe.send(Refused(error=ErrorData.of(_fault_of_ours(error))))
        pushed = pipe.push_all(LAST_WORDS_S)
        return "" if pushed and not command.ended else words  # a pipe takes words until its reader is gone


class _Command:
    """The command at the other end: `Watched`, `Terminal` and `Progress` of the run."""

    def __init__(self, pipe: IpcPipe, stop: StopRequest) -> None:
        self._pipe, self._stop = pipe, stop
        self._lines: list[str | EmergencyAsked] = []
        self._process = os.getppid()
        self._heard_s = time.monotonic()
        self.ended = False
        self.alone_after_s = float("inf")

    def asked(self) -> RunAsked | None:
        """The run that is asked for; None if the command is gone before it has asked."""
        until_s = time.monotonic() + ASKED_WITHIN_S
        found = None
        while found is None and not self._pipe.gone and time.monotonic() < until_s:
            self._pipe.wait(1.0)
            for message in self._pipe.fetch():
                if isinstance(message, RunAsked):
                    found = message
                else:
                    self._take(message)
        return found

    def turned(self) -> str:
        """Report that the loop has turned, and take what the command has sent."""
        self._pipe.send_if_idle(Turned())
        for message in self._pipe.fetch():
            self._take(message)
        self.ended = self._pipe.gone or is_ending(self._process)
        if self.ended:
            return "the command of this run has ended"
        silent_s = time.monotonic() - self._heard_s
        return f"the command has been silent for {silent_s:.1f} s" if silent_s > self.alone_after_s else ""

    def concluded(self, *, armed: bool, unsafe: Sequence[str]) -> None:
        """Say that the loop has done its part."""
        self._pipe.send(Concluded(armed=armed, unsafe=tuple(unsafe)))

    def progress(self, share: float, text: str) -> None:
        """Say how far the run is, unless no one listens."""
        if not self._pipe.crowded:
            self._pipe.send(Progressed(share=share, text=text))

    def tell(self, text: str, question: Question | None = None) -> None:
        """Show a text to the operator; with `question` an answer is awaited."""
        self._pipe.send(OperatorText(text=text, question=question))

    def typed(self) -> list[str | EmergencyAsked]:
        """What the operator has typed, and others asked for, since the last call."""
        lines, self._lines = self._lines, []
        return lines

    def _take(self, message: Message) -> None:
        self._heard_s = time.monotonic()
        if isinstance(message, Typed):
            self._lines.append(message.line)
        elif isinstance(message, EmergencyAsked):
            self._lines.append(message)
        elif isinstance(message, StopAsked):
            while self._stop.times < message.times:
                self._stop.ask()


class _LogLines(logging.Handler):
    """The log goes to the command, which knows what becomes of it."""

    def __init__(self, pipe: IpcPipe) -> None:
        super().__init__()
        self._pipe = pipe

    def emit(self, record: logging.LogRecord) -> None:
        """Send it, unless no one listens."""
        if self._pipe.crowded:
            return
        trace = logging.Formatter().formatException(record.exc_info) if record.exc_info else ""
        text = record.getMessage()
        self._pipe.send(Logged(logger=record.name, level=record.levelno, text=text, traceback=trace))


def _log_to(pipe: IpcPipe) -> None:
    handler = _LogLines(pipe)
    for name in PACKAGES:
        logging.getLogger(name).setLevel(logging.DEBUG)
        logging.getLogger(name).addHandler(handler)


def _fault_of_ours(error: Exception) -> BenchError:
    at = traceback.extract_tb(error.__traceback__)[-1]
    return BenchError(
        f"internal error: {type(error).__name__}: {error}",
        where=f"{Path(at.filename).name}:{at.lineno}",
        fix="please report it with the log, the command and its input",
    )
