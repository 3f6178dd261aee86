"""Has a run executed by a process that holds the hardware, and watches it: docs/decisions/0017.

Nothing here is needed for the bench to be safe: RMCU and dynos switch off by themselves when their host is
gone. The supervisor says so, looks whether it is so, and keeps what was measured.
"""

from __future__ import annotations

import contextlib
import logging
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence

from hil.core.errors import BenchError, EmergencyStopError, HilError, InterruptError
from hil.core.result import SafeState
from hil.engine.bench.bench_tables import BenchFile
from hil.engine.ipc.ipc import RECORDING, RunOutcome, RunRequest
from hil.engine.ipc.ipc_data import asked_of, outcome_of
from hil.engine.ipc.ipc_messages import (
    Concluded,
    EmergencyAsked,
    Ended,
    Here,
    Logged,
    Message,
    OperatorText,
    Progressed,
    Refused,
    StopAsked,
    Turned,
    Typed,
)
from hil.engine.ipc.ipc_pipe import IpcPipe
from hil.engine.process.lost_process import complaints_of, identity_of, recording_left, result_left
from hil.engine.run.operator import EMERGENCY, LOOK_S, typed_emergency
from hil.engine.run.run import run_plan
from hil.engine.stop.emergency_stop import keep_latched
from hil.engine.stop.stopping import held_back

_HERE_S = 0.1  # how often the other process hears of this one
#: Outside of the loop: opening compiles on a machine's first run, concluding judges hours of recording.
_OPENING_S = _CONCLUDING_S = 900.0
#: For a process that has reported its outcome, or lost its command's end of the pipe, to end by itself.
_LEAVING_S = 30.0
_REAPED_S = 1.0
_WHERE = "the process that holds the bench"
_FIX = "cut the drives' power before you approach the bench"

logger = logging.getLogger(__name__)


def execute(request: RunRequest, command: Sequence[str], keeps: Sequence[int] = ()) -> RunOutcome:
    """Execute a plan: on hardware in a process of its own, else in this one.

    Args:
        command: starts a process that calls `hold_hardware` with its standard input and output.
        keeps: descriptors that it keeps open, such as the lock of the folder that it writes to.

    Raises:
        BadInputError: before anything was moved: plan, bench or place cannot be used.
        BenchError: before anything was moved: the bench does not come up.
    """
    if not _apart(request.bench):
        return run_plan(request)
    with _started(command, keeps) as (process, pipe):
        return _Supervisor(request, process, pipe).outcome()


def _apart(bench: BenchFile) -> bool:
    """Whether a process of its own is to hold it; without POSIX's pipes there is none."""
    wanted = bench.supervision.own_process
    return os.name == "posix" and (bench.simulation is None if wanted is None else wanted)


@contextlib.contextmanager
def _started(
    command: Sequence[str], keeps: Sequence[int]
) -> Iterator[tuple[subprocess.Popen[bytes], IpcPipe]]:
    """The process; however this is left, it ends: by itself if it can, for it makes its bench safe."""
    with held_back():  # one that comes before the other process can answer it would end it without a word
        process = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            pass_fds=keeps,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
            start_new_session=True,  # a terminal's Ctrl-C is for this process, which tells the other once
        )
    assert process.stdin is not None
    assert process.stdout is not None
    logger.info("the bench is held by process %d", process.pid)
    pipe = IpcPipe(os.dup(process.stdout.fileno()), os.dup(process.stdin.fileno()))
    process.stdin.close()
    process.stdout.close()
    try:
        yield process, pipe
    finally:
        pipe.close()
        try:
            process.wait(_LEAVING_S)
        except subprocess.TimeoutExpired:
            _kill(process)


def _kill(process: subprocess.Popen[bytes]) -> None:
    """End it at once, if it has not ended: it is a child of this process and was not waited for before."""
    process.kill()
    process.wait()


class _Supervisor:
    """Passes on what is stated on both sides, until the run has ended or its process must be given up."""

    def __init__(self, request: RunRequest, process: subprocess.Popen[bytes], pipe: IpcPipe) -> None:
        self._request, self._process, self._pipe = request, process, pipe
        settings, scale = request.bench.supervision, request.bench.time_scale
        self._hung_after_s = settings.hung_after_s / scale
        self._turning = False
        self._concluded: Concluded | None = None
        self._heard_s = self._stopped_s = time.monotonic()
        self._here_s = -1.0
        self._asked_s: float | None = None
        self._reported_stops = 0
        self._emergency: EmergencyStopError | None = None
        self._path = request.out / RECORDING
        self._recorded_before = identity_of(self._path)

    def outcome(self) -> RunOutcome:
        """How the run ended, whoever says so.

        Raises:
            HilError: there was no run.
        """
        self._pipe.send(asked_of(self._request))
        while True:
            self._pipe.wait(LOOK_S)
            self._speak()
            gone = self._pipe.gone  # what is read after it is all there was
            for message in self._pipe.fetch():
                self._heard_s = time.monotonic()
                if isinstance(message, Refused):
                    raise message.error.as_error()
                if isinstance(message, Ended):
                    return outcome_of(message)
                self._take(message)
            why = "has ended" if gone else self._given_up()
            if why:
                return self._lost(why)

    def _speak(self) -> None:
        """Tell the other process what the operator wants, and that this one is here."""
        now_s = time.monotonic()
        terminal, stop = self._request.terminal, self._request.stop
        for line in terminal.typed() if terminal is not None else ():
            if isinstance(line, EmergencyAsked):
                self._emergency = self._emergency or line.as_error()
                self._pipe.send(line)
                continue
            if line.strip().lower() == EMERGENCY:
                self._emergency = self._emergency or typed_emergency()
            self._pipe.send(Typed(line=line))
        if stop.times > self._reported_stops:
            self._reported_stops = stop.times
            self._asked_s = self._asked_s or now_s
            self._pipe.send(StopAsked(times=stop.times))
        if now_s - self._here_s > _HERE_S:
            self._here_s = now_s
            self._pipe.send_if_idle(Here())
        self._pipe.push()

    def _take(self, message: Message) -> None:
        if isinstance(message, Turned):
            self._turning = self._concluded is None
        elif isinstance(message, Progressed):
            self._request.progress(message.share, message.text)
        elif isinstance(message, OperatorText) and self._request.terminal is not None:
            self._request.terminal.tell(message.text, message.question)
        elif isinstance(message, Logged):
            _log(message)
        elif isinstance(message, Concluded):
            self._concluded, self._turning = message, False

    def _given_up(self) -> str:
        """Why the other process is given up; '' if it is not."""
        now_s = time.monotonic()
        silent_s = now_s - self._heard_s
        stopped = _is_stopped(self._process.pid)
        self._stopped_s = self._stopped_s if stopped else now_s
        if stopped and now_s - self._stopped_s > self._hung_after_s:
            return f"was stopped (SIGSTOP) for {now_s - self._stopped_s:.1f} s"
        if self._turning:
            seen = "was stopped (SIGSTOP)" if stopped else "hung: its loop was not running"
            return f"{seen} for {silent_s:.1f} s" if silent_s > self._hung_after_s else ""
        if self._concluded is None and self._asked_s is not None:
            # It looks only from its loop; nothing has been commanded before that turns.
            waits_s = now_s - max(self._asked_s, self._heard_s)
            return "was still opening the bench" if waits_s > self._hung_after_s else ""
        longest_s = _OPENING_S if self._concluded is None else _CONCLUDING_S
        return f"hung: it sent nothing for {silent_s:.0f} s" if silent_s > longest_s else ""

    def _lost(self, why: str) -> RunOutcome:
        """What can be stated of a run whose process has been given up, or has ended without a word.

        Raises:
            HilError: it had not started to record.
        """
        if why == "has ended":
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(_REAPED_S)
            why = _ending(self._process.poll())
        _kill(self._process)
        logger.error("%s %s", _WHERE, why)
        safe, words = self._safe_state()
        recording = recording_left(self._path, self._recorded_before)
        error = self._error(why, words or "nothing was commanded", recorded=recording is not None)
        stopped = keep_latched(error, self._request.bench, self._request.out, self._request.stops)
        if recording is None:
            raise error
        result = result_left(recording, self._request, safe, error)
        result = result.model_copy(update={"emergency_stop": stopped})
        return RunOutcome(result, self._path, error, {})

    def _safe_state(self) -> tuple[SafeState, str]:
        """As the process has read it back before it was lost, or as the bench itself says now."""
        concluded, bench = self._concluded, self._request.bench
        if concluded is not None and not concluded.armed:
            return "not_needed", ""
        if concluded is None and (not self._turning or bench.simulation is not None):
            return "not_needed", ""
        complaints = list(concluded.unsafe) if concluded is not None else complaints_of(bench)
        if complaints:
            return "not_confirmed", f"safe: not confirmed ({'; '.join(complaints)})"
        return "confirmed", "safe: confirmed"

    def _error(self, why: str, words: str, *, recorded: bool) -> HilError:
        if self._asked_s is not None and not self._turning and self._concluded is None:
            return InterruptError(f"stopped by the operator, when {_WHERE} {why}")
        out = self._request.out
        fixes = [_FIX] if "not confirmed" in words else []
        if recorded:
            fixes.append(f"hil evidence recover {out} recovers the recording of what was measured")
        fix = "; ".join(fixes)
        what = f"{why}; {words}"
        if self._emergency:
            stop = self._emergency
            words = f"{stop.what}; {_WHERE} {what}"
            return EmergencyStopError(words, by=stop.by, origin=stop.origin, way=stop.way, fix=fix)
        return BenchError(what, where=_WHERE, fix=fix)


def _log(line: Logged) -> None:
    """A line of the other process's log, as if it were of this one's."""
    log = logging.getLogger(line.logger)
    record = log.makeRecord(line.logger, line.level, "", 0, line.text, (), None)
    if line.traceback:
        record.exc_info = (BenchError, BenchError(line.text), None)
        record.exc_text = line.traceback
    log.handle(record)


def _is_stopped(number: int) -> bool:
    """Whether a child of this process has been stopped (SIGSTOP) and not continued; it stays waited for."""
    with contextlib.suppress(OSError):
        return os.waitid(os.P_PID, number, os.WSTOPPED | os.WNOHANG | os.WNOWAIT) is not None
    return False


def _ending(code: int | None) -> str:
    """How a process ended, in words."""
    if code is None:
        return "no longer responds"
    if code >= 0:
        return f"ended with code {code} without a message"
    try:
        return f"was ended by {signal.Signals(-code).name}"
    except ValueError:
        return f"was ended by signal {-code}"
