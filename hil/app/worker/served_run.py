"""`python -m hil.app.worker.served_run`: one run for a service or an agent, which starts it.

It does what `hil run` does. In place of a terminal it has two pipes with the messages of
`hil.engine.ipc.ipc_messages`: asked and typed come in, progress, texts and the outcome go out. A second
argument is the descriptor of its stop line: emergency stops come by it that no other message can hold up.
"""

from __future__ import annotations

import contextlib
import logging
import os
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from hil.app.feedback import LoggedFeedback, telling_of_compilation
from hil.app.interrupts import INTERRUPTS
from hil.engine.process.hardware_process import ASKED_WITHIN_S, LAST_WORDS_S

if TYPE_CHECKING:
    from hil.app.feedback import Show
    from hil.engine.ipc.ipc_messages import EmergencyAsked, Message, Question, RunAsked
    from hil.engine.ipc.ipc_pipe import IpcPipe

LOG_FILE = "log.txt"
#: Starts it.
RUNNER = (sys.executable, "-m", "hil.app.worker.served_run")

logger = logging.getLogger(__name__)


class _Service(LoggedFeedback):
    """The service at the other end: the operator's terminal and the run's feedback, the rest to its log."""

    def __init__(self, pipe: IpcPipe, stop_line: IpcPipe | None) -> None:
        self._pipe, self._stop_line = pipe, stop_line
        self._asked_to_end = False
        self._early: list[Message] = []  # came with the request: somebody was quick

    def request(self) -> RunAsked | None:
        """The run that is asked for; None if the service is gone before it has asked."""
        from hil.engine.ipc.ipc_messages import RunAsked

        until_s = time.monotonic() + ASKED_WITHIN_S
        while not self._pipe.gone and time.monotonic() < until_s:
            self._pipe.wait(1.0)
            found: RunAsked | None = None
            for message in self._pipe.fetch():
                if found is None and isinstance(message, RunAsked):
                    found = message
                else:
                    self._early.append(message)
            if found is not None:
                return found
        return None

    def tell(self, text: str, question: Question | None = None) -> None:
        """Show the operators a text; with `question` an answer is awaited."""
        from hil.engine.ipc.ipc_messages import OperatorText

        self._pipe.send(OperatorText(text=text, question=question))

    def typed(self) -> list[str | EmergencyAsked]:
        """What operators asked for since the last call; that the service has gone ends the run."""
        from hil.engine.ipc.ipc_messages import EmergencyAsked, Typed
        from hil.engine.run.operator import GONE

        lines: list[str | EmergencyAsked] = []
        early, self._early = self._early, []
        stops = self._stop_line.fetch() if self._stop_line else ()
        for message in [*stops, *early, *self._pipe.fetch()]:
            if isinstance(message, Typed):
                lines.append(message.line)
            elif isinstance(message, EmergencyAsked):
                lines.append(message)
        if self._pipe.gone and not self._asked_to_end:
            self._asked_to_end = True
            lines.append(GONE)
        return lines

    @contextlib.contextmanager
    def progress(self, description: str) -> Iterator[Show]:
        """Send the progress on."""
        del description
        from hil.engine.ipc.ipc_messages import Progressed

        def show(text: str, share: float | None = None) -> None:
            if not self._pipe.crowded:
                self._pipe.send(Progressed(share=-1.0 if share is None else share, text=text))

        with telling_of_compilation(show):
            yield show

    def complain(self, text: str) -> None:
        """For the run's log; the outcome has it, too."""
        logger.warning(text)

    def ask_name(self, question: str, given: str) -> str:
        """No one is asked here."""
        del question
        return given

    def terminal(self) -> _Service:
        """This one."""
        return self


def main() -> None:
    """Execute the run that is asked for on standard input, and exit with the code that `hil run` has."""
    INTERRUPTS.raise_from_now_on()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    os.environ.setdefault(
        "PYTHONWARNINGS", "ignore"
    )  # of processes started by this one; here the log has them
    reading, writing = os.dup(0), os.dup(1)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(2, 1)  # what a library prints is no message
    from hil.app.worker.lean_imports import import_python_can

    import_python_can()
    from hil.app.log import LOG
    from hil.core.errors import BenchError, HilError
    from hil.engine.ipc.ipc_messages import ErrorData, Refused
    from hil.engine.ipc.ipc_pipe import IpcPipe

    pipe = IpcPipe(reading, writing)
    service = _Service(pipe, _stop_line())
    LOG.begin(sys.argv)
    code = 130
    try:
        request = service.request()
        if request is not None:
            code = _execute(request, service, pipe)
    except HilError as error:
        code = error.exit_code
        pipe.send(Refused(error=ErrorData.of(error)))
    except KeyboardInterrupt:
        INTERRUPTS.answered()
    except Exception as error:
        logger.exception("internal error")
        what = f"internal error: {type(error).__name__}: {error}"
        fault = BenchError(what, where=LOG_FILE, fix="please report it with the run's log")
        code = fault.exit_code
        pipe.send(Refused(error=ErrorData.of(fault)))
    pipe.push_all(LAST_WORDS_S)
    INTERRUPTS.ignore_from_now_on()
    LOG.end()
    sys.exit(code)


def _stop_line() -> IpcPipe | None:
    """Only read from; no one else has this end of it."""
    from hil.engine.ipc.ipc_pipe import IpcPipe

    if len(sys.argv) < 3:
        return None
    line = int(sys.argv[2])
    os.set_inheritable(line, False)
    return IpcPipe(line, line)


def _execute(asked: RunAsked, service: _Service, pipe: IpcPipe) -> int:
    from hil.app.log import LOG
    from hil.app.run import RunSettings
    from hil.engine.ipc.ipc_data import ended_of, request_of

    request = request_of(asked)
    out = Path(asked.out)
    LOG.send(out / LOG_FILE, verbose=False)
    settings = RunSettings(
        model=request.model,
        operator=request.operator,
        confirmed_by=request.confirmed_by,
        hazard_confirmed_by=request.hazard_confirmed_by,
        accept_expired=request.accept_expired,
        inputs=(request.bench.source, request.plan.source),
        overwrite=False,
        feedback=service,
        stops=request.stops,
    )
    with settings.execute(request.plan, request.bench, out) as run:
        outcome = run.outcome
        outcome.result = run.result
        pipe.send(ended_of(outcome))
        return run.exit_code


if __name__ == "__main__":
    main()
