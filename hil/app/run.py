"""One run, from its request to its reports."""

from __future__ import annotations

import contextlib
import logging
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from hil.app.feedback import LOGGED, Feedback, Show
from hil.app.interrupts import INTERRUPTS
from hil.app.result_file import RESULT, write_result
from hil.app.results_folder import ResultsFolder, results_in
from hil.app.worker.hold import HOLDER
from hil.core.errors import BenchError, HilError, InterruptError
from hil.core.model import Model
from hil.core.recording import Recording, read_recording
from hil.core.result import RunResult
from hil.engine import RECORDING, BenchFile, RunOutcome, RunRequest, StopRequest
from hil.engine import execute as carry_out_run
from hil.engine.ipc.ipc import analysed_apart
from hil.engine.run.preflight import remark_on_room
from reports import HTML, JUNIT, PDF, write_documents, write_junit
from test_plans import Plan

logger = logging.getLogger(__name__)
T = TypeVar("T")
NAMES = (RECORDING, RESULT, JUNIT, HTML, PDF)


@dataclass(frozen=True)
class FinishedRun:
    """A run that has ended, with what is written of it."""

    outcome: RunOutcome
    result: RunResult
    folder: Path

    @property
    def exit_code(self) -> int:
        """As docs/reference/commands.md has it."""
        if self.result.safe_state == "not_confirmed":
            return BenchError.exit_code
        if self.outcome.error is not None:
            return self.outcome.error.exit_code
        return {"pass": 0, "done": 0, "fail": 1, "error": BenchError.exit_code}[self.result.verdict]


@dataclass(frozen=True)
class RunSettings:
    """What the runs of one request have in common.

    Attributes:
        inputs: files that are read, none of which is ever written over.
        stops: where the latch of an emergency stop lies, if not in the default folder.
    """

    model: Model | None
    operator: str
    confirmed_by: str
    hazard_confirmed_by: str
    accept_expired: str
    inputs: tuple[Path, ...]
    overwrite: bool
    feedback: Feedback = LOGGED
    stops: Path | None = None

    @contextlib.contextmanager
    def execute(self, plan: Plan, bench: BenchFile, out: Path | None) -> Iterator[FinishedRun]:
        """Carry it out and write its reports; the folder is this command's until the block ends."""
        stop = StopRequest()
        request = RunRequest(
            plan=plan,
            bench=bench,
            out=Path(),
            model=self.model,
            operator=self.operator,
            terminal=self.feedback.terminal(),
            confirmed_by=self.confirmed_by,
            accept_expired=self.accept_expired,
            hazard_confirmed_by=self.hazard_confirmed_by,
            analyse=analysed_apart,
            stop=stop,
            stops=self.stops,
        )
        with (
            results_in(
                out,
                NAMES,
                inputs=self.inputs,
                overwrite=self.overwrite,
                default=plan.name,
                summary=RESULT,
            ) as place,
            stop.by_signals(),  # from here to the result a signal only asks: nothing measured is lost
        ):
            run = self._execute(request, place, stop)
            if run.outcome.error is not None:
                self.feedback.complain(str(run.outcome.error))
            yield run

    def _execute(self, request: RunRequest, place: ResultsFolder, stop: StopRequest) -> FinishedRun:
        plan, bench = request.plan, request.bench
        request.out, request.replaces = place.folder, place.stale
        remark = remark_on_room(plan, place.folder)
        if remark:
            self.feedback.warn(remark)
        keys = f" ({self.feedback.keys})" if request.terminal is not None else ""
        with self.feedback.progress(f"{plan.name} on {bench.name}{keys}") as show:
            request.progress = lambda share, text: show(text, share)
            outcome = carry_out_run(request, HOLDER, keeps=[place.lock])
        with self.feedback.progress(f"{plan.name} on {bench.name}") as show:
            result = _Conclusion(place, outcome, stop).write(show)
        return FinishedRun(outcome, result, place.folder)


class _Conclusion:
    """What is written once the bench is safe: the result first, then the slow reports."""

    def __init__(self, place: ResultsFolder, outcome: RunOutcome, stop: StopRequest) -> None:
        self._place, self._outcome, self._stop = place, outcome, stop
        self._files = {"recording": outcome.recording.name}
        self._files |= {name: name for name in outcome.made}

    def write(self, show: Show) -> RunResult:
        """The result as it stands in result.json; `files` names what exists."""
        show("writing the result")
        path = self._outcome.recording
        recording = self._try(lambda: read_recording(path, least_samples=0, allow_missing=True))
        recording = recording or Recording({}, path)  # the verdicts are reported all the same
        self._add(lambda: {"junit": write_junit(recording, self._outcome.result, self._path(JUNIT))})
        result = self._store(recording)
        if not self._asked_again():
            show("writing the reports")
            self._add(lambda: self._documents(recording, result))
            result = self._store(recording)
        if self._asked_again() and "pdf" not in self._files:
            error = InterruptError(
                "interrupted before the reports were written",
                where=str(self._place.folder),
                fix=f"make them with: hil report {self._place.folder}",
            )
            self._outcome.error = self._outcome.error or error
        return result

    def _asked_again(self) -> bool:
        """Whether somebody asked to stop since the run ended, or twice while it was being ended."""
        return self._stop.times > (1 if isinstance(self._outcome.error, InterruptError) else 0)

    def _documents(self, recording: Recording, result: RunResult) -> dict[str, Path]:
        try:
            INTERRUPTS.raise_from_now_on()
            return write_documents(recording, result, self._place.folder)
        except KeyboardInterrupt:
            INTERRUPTS.answered()
            self._stop.ask()
            return {}
        finally:
            INTERRUPTS.ignore_from_now_on()

    def _store(self, recording: Recording) -> RunResult:
        result = self._outcome.result
        written = self._try(lambda: write_result(result, recording, self._files, self._place.folder))
        return written or result.model_copy(update={"files": dict(self._files)})

    def _add(self, write: Callable[[], dict[str, Path]]) -> None:
        written = self._try(write)
        self._files |= {kind: path.name for kind, path in (written or {}).items()}

    def _try(self, work: Callable[[], T]) -> T | None:
        """The first failure is the run's error; the rest is still written."""
        try:
            return work()
        except HilError as error:
            self._outcome.error = self._outcome.error or error
        except Exception as error:  # a mistake in a report must not cost the run its result
            logger.exception("the reports")
            failure = BenchError(f"{type(error).__name__}: {error}", where="reports", fix="please report it")
            self._outcome.error = self._outcome.error or failure
        return None

    def _path(self, name: str) -> Path:
        return self._place.folder / name
