"""`python -m hil.cli._served_run`: one run for the bench service, which starts it; nobody else does.

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

from hil.cli._interrupts import INTERRUPTS

if TYPE_CHECKING:
    from hil.cli._output import Show
    from hil.engine.ipc.ipc_messages import EmergencyAsked, RunAsked
    from hil.engine.ipc.ipc_pipe import IpcPipe

_ASKED_WITHIN_S = 60.0
_LAST_WORDS_S = 10.0
LOG_FILE = "log.txt"
#: Start the command line, and a run for a service or an agent, as processes of their own.
HIL = (sys.executable, "-c", "from hil.cli import main; main()")
RUNNER = (sys.executable, "-m", "hil.cli._served_run")


class _Service:
    """The service at the other end: the operator's terminal, and who is shown the progress."""

    def __init__(self, pipe: IpcPipe, stop_line: IpcPipe | None) -> None:
        self._pipe, self._stop_line = pipe, stop_line
        self._told_end = False

    def asked(self) -> RunAsked | None:
        """The run that is asked for; None if the service is gone before it has asked."""
        from hil.engine.ipc.ipc_messages import RunAsked

        until_s = time.monotonic() + _ASKED_WITHIN_S
        while not self._pipe.gone and time.monotonic() < until_s:
            self._pipe.wait(1.0)
            for message in self._pipe.fetch():
                if isinstance(message, RunAsked):
                    return message
        return None

    def tell(self, text: str) -> None:
        """Show the operators a text."""
        from hil.engine.ipc.ipc_messages import Told

        self._pipe.send(Told(text=text))

    def typed(self) -> list[str | EmergencyAsked]:
        """What operators asked for since the last call; that the service has gone ends the run."""
        from hil.engine.ipc.ipc_messages import EmergencyAsked, Typed

        lines: list[str | EmergencyAsked] = []
        for message in [*(self._stop_line.fetch() if self._stop_line else ()), *self._pipe.fetch()]:
            if isinstance(message, Typed):
                lines.append(message.line)
            elif isinstance(message, EmergencyAsked):
                lines.append(message)
        if self._pipe.gone and not self._told_end:
            self._told_end = True
            lines.append("q")
        return lines

    @contextlib.contextmanager
    def shown(self, description: str) -> Iterator[Show]:
        """Send the progress on."""
        del description
        from hil.engine.ipc.ipc_messages import Progressed

        def show(text: str, share: float | None = None) -> None:
            if not self._pipe.crowded:
                self._pipe.send(Progressed(share=-1.0 if share is None else share, text=text))

        yield show


def main() -> None:
    """Carry out the run that is asked for on standard input, and exit with the code that `hil run` has."""
    INTERRUPTS.raise_from_now_on()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    os.environ.setdefault("PYTHONWARNINGS", "ignore")  # of processes begun by this one; here the log has them
    reading, writing = os.dup(0), os.dup(1)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(2, 1)  # what a library prints is no message
    from hil.cli._lean_imports import import_python_can

    import_python_can()
    from hil.cli._log import LOG
    from hil.core.errors import BenchError, HilError
    from hil.engine.ipc.ipc_messages import ErrorData, Refused
    from hil.engine.ipc.ipc_pipe import IpcPipe

    pipe = IpcPipe(reading, writing)
    service = _Service(pipe, _stop_line())
    LOG.begin(sys.argv)
    code = 130
    try:
        asked = service.asked()
        if asked is not None:
            code = _carried_out(asked, service, pipe)
    except HilError as error:
        code = error.exit_code
        pipe.send(Refused(error=ErrorData.of(error)))
    except KeyboardInterrupt:
        INTERRUPTS.answered()
    except Exception as error:
        logging.getLogger(__name__).exception("internal error")
        what = f"internal error: {type(error).__name__}: {error}"
        fault = BenchError(what, where=LOG_FILE, fix="please report it with the run's log")
        code = fault.exit_code
        pipe.send(Refused(error=ErrorData.of(fault)))
    pipe.push_all(_LAST_WORDS_S)
    INTERRUPTS.ignore_from_now_on()
    LOG.end()
    sys.exit(code)


def _stop_line() -> IpcPipe | None:
    """Only read from; nobody else has this end of it."""
    from hil.engine.ipc.ipc_pipe import IpcPipe

    if len(sys.argv) < 3:
        return None
    line = int(sys.argv[2])
    os.set_inheritable(line, False)
    return IpcPipe(line, line)


def _carried_out(asked: RunAsked, service: _Service, pipe: IpcPipe) -> int:
    from hil.cli._log import LOG
    from hil.cli._one_run import Runs
    from hil.engine.ipc.ipc_data import ended_of, request_of

    request = request_of(asked)
    out = Path(asked.out)
    LOG.send(out / LOG_FILE, verbose=False)
    runs = Runs(
        model=request.model,
        operator=request.operator,
        confirmed_by=request.confirmed_by,
        hazard_confirmed_by=request.hazard_confirmed_by,
        accept_expired=request.accept_expired,
        inputs=(request.bench.source, request.plan.source),
        overwrite=False,
        terminal=lambda: service,
        shown=service.shown,
        stops=request.stops,
    )
    with runs.finished(request.plan, request.bench, out) as run:
        outcome = run.outcome
        outcome.result = run.result
        pipe.send(ended_of(outcome))
        return run.exit_code


if __name__ == "__main__":
    main()
