"""`hil run`: a plan on a bench, with its recording and reports."""

from __future__ import annotations

import logging
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from hil.cli._browser import show_in_browser
from hil.cli._hold import HOLDER
from hil.cli._interrupts import INTERRUPTS
from hil.cli._output import (
    Show,
    console,
    count_in_words,
    expiry_in_words,
    print_criteria,
    print_json,
    progress,
    told_identities,
    warn,
)
from hil.cli._place import Place, results_in
from hil.cli._result_file import RESULT, write_result
from hil.cli._streams import complain
from hil.cli._terminal import KEYS, operators_terminal
from hil.cli._timing import times_in_words, timing_in_words
from hil.core.errors import BenchError, HilError, InterruptError
from hil.core.model import load_model
from hil.core.printable import printable
from hil.core.recording import Recording, read_recording
from hil.core.result import RunResult
from hil.engine import RECORDING, RunOutcome, RunRequest, StopRequest, load_bench
from hil.engine import carry_out as carried_out
from hil.engine.border import analysed_apart
from hil.engine.disk_room import remark_on_room
from reports import HTML, JUNIT, PDF, write_documents, write_junit
from test_plans import Choices, Plan, controller_choices, load_plan

logger = logging.getLogger(__name__)
T = TypeVar("T")
NAMES = (RECORDING, RESULT, JUNIT, HTML, PDF)


def carry_out(
    *,
    plan: str,
    bench: str,
    out: Path | None,
    model: Path | None,
    controller: list[str] | None,
    operator: str,
    yes: str,
    confirm: str,
    accept_expired: str,
    overwrite: bool,
    show: bool,
    as_json: bool,
) -> int:
    """Carry the command out; its exit code."""
    controllers = controller_choices(controller or [], "--controller")
    checked, bench_file = load_plan(plan, Choices(controllers)), load_bench(bench)
    stop = StopRequest()
    request = RunRequest(
        plan=checked,
        bench=bench_file,
        out=Path(),
        model=load_model(model) if model else None,
        operator=operator,
        terminal=operators_terminal(),
        confirmed_by=yes,
        accept_expired=accept_expired,
        hazard_confirmed_by=confirm or _asked_for_name(checked),
        analyse=analysed_apart,
        stop=stop,
    )
    inputs = [bench_file.source, *([Path(plan)] if Path(plan).is_file() else []), *([model] if model else [])]
    inputs += controllers.values()
    with (
        results_in(
            out, NAMES, inputs=inputs, overwrite=overwrite, default=checked.name, summary=RESULT
        ) as place,
        stop.by_signals(),  # from here to the result a signal only asks: nothing that was measured is lost
    ):
        request.out, request.replaces = place.folder, place.stale
        remark = remark_on_room(checked, place.folder)
        if remark:
            warn(remark)
        with progress(f"{checked.name} on {bench_file.name}{_keys(request)}") as tell:
            request.progress = lambda share, text: tell(text, share)
            outcome = carried_out(request, HOLDER, keeps=[place.lock])
        with progress(f"{checked.name} on {bench_file.name}") as tell:
            result = _Conclusion(place, outcome, stop).write(tell)
        if as_json:
            print_json(result.model_dump(mode="json"))
        else:
            _print(result, place.folder)
        if show and "html" in result.files:
            show_in_browser(place.folder / result.files["html"])
        return _exit_code(outcome, result)


class _Conclusion:
    """What is written once the bench is safe: the result first, then the slow reports."""

    def __init__(self, place: Place, outcome: RunOutcome, stop: StopRequest) -> None:
        self._place, self._outcome, self._stop = place, outcome, stop
        self._files = {"recording": outcome.recording.name}
        self._files |= {name: name for name in outcome.made}

    def write(self, show: Show) -> RunResult:
        """The result as it stands in result.json; `files` names what exists."""
        show("writing the result")
        path = self._outcome.recording
        recording = self._try(lambda: read_recording(path, least_samples=0, allow_missing=True))
        recording = recording or Recording({}, path)  # the verdicts are told all the same
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
                fix=f"hil report {self._place.folder} makes them",
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


def _asked_for_name(plan: Plan) -> str:
    """Who takes a hazardous plan upon them; asked before anything of the bench is opened."""
    if not plan.hazardous or not sys.stdin.isatty():
        return ""
    why = f": {printable(plan.hazardous, 500)}" if isinstance(plan.hazardous, str) else ""
    print(f"The plan {plan.name} is hazardous{why}\nYour name, to carry it out:", file=sys.stderr)
    return sys.stdin.readline().strip()


def _keys(request: RunRequest) -> str:
    return f" ({KEYS})" if request.terminal is not None else ""


def _exit_code(outcome: RunOutcome, result: RunResult) -> int:
    if outcome.error is not None:
        complain("error", str(outcome.error))
    if result.safe_state == "not_confirmed":
        return BenchError.exit_code
    if outcome.error is not None:
        return outcome.error.exit_code
    return 0 if result.verdict == "pass" else 1


def _print(result: RunResult, folder: Path) -> None:
    page = console()
    if result.criteria:
        print_criteria(page, result.criteria)
    page.print(
        f"\n{result.plan} on {result.bench}: [bold]{result.verdict.upper()}[/], "
        f"{count_in_words(result.criteria)}   safe state {result.safe_state.replace('_', ' ')}   "
        f"{result.bench_time_s:.0f} s of bench time, {times_in_words(result.real_time_factor)} x real time",
        highlight=False,
    )
    for line in timing_in_words(result.timing):
        page.print(line, highlight=False)
    for limit in result.limits:
        if limit.reached:
            warn(f"limit {limit.name} was reached {limit.reached} times; response: {limit.response}")
    for text in result.missing:
        warn(text)
    if result.accepted_expired:
        warn(expiry_in_words(result.accepted_expired))
    said = told_identities(result.identities)
    if said:
        page.print(f"identification: {said}", highlight=False, markup=False, soft_wrap=True)
    shown = "html" if "html" in result.files else "recording"
    page.print(f"{'report' if shown == 'html' else shown}: {folder / result.files[shown]}", highlight=False)
