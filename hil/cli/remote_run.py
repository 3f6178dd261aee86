"""`hil --server URL run`: a run that a bench service executes; progress and exit codes as of one here."""

from __future__ import annotations

import contextlib
import os
import queue
import secrets
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from hil.api_schemas.api import OVER, RunData, RunWanted
from hil.app.result_file import RESULT
from hil.app.results_folder import ResultsFolder, results_in
from hil.app.run import NAMES
from hil.cli.output import progress
from hil.cli.streams import KEYS, StandardTerminal, complain, operators_terminal
from hil.client import Client, RefusedError
from hil.client.retry import OURS, Retry
from hil.client.sent_plan import give_plan
from hil.core.errors import BadInputError, BenchError, InterruptError
from hil.core.result import RunResult
from hil.engine import StopRequest
from hil.engine.run.operator import EMERGENCY
from test_plans import load_plan

_LOOK_S = 0.3
_KEYS_S = 0.05
TOKEN = "HIL_TOKEN"

Tell = Callable[[RunResult, Path], None]


@dataclass(frozen=True)
class RemoteRun:
    """What is wanted of a service; `plan` is a name that it knows, or a file that it is given."""

    server: str
    plan: str
    bench: str
    values: dict[str, float]
    confirmed_by: str
    accept_expired: str
    overwrite: bool

    def execute(self, out: Path | None, tell: Tell) -> int:
        """Have it executed and bring its files here; its exit code."""
        client = Client(self.server, os.environ.get(TOKEN, ""))
        stop = StopRequest()
        with (
            results_in(
                out, NAMES, overwrite=self.overwrite, default=Path(self.plan).stem, summary=RESULT
            ) as place,
            stop.by_signals(),
        ):
            with contextlib.suppress(BenchError):
                client.find_stop_post()  # now: a service that is flooded answers late
            run = self._queued(client)
            run = _Watching(client, run, stop).until_over()
            return _brought(client, run, place, tell)

    def _queued(self, client: Client) -> RunData:
        """The run as the service has it.

        Raises:
            BadInputError: the service refuses it.
            BenchError: the service cannot be reached.
        """
        try:
            name = self.plan
            if Path(name).is_file():
                name = give_plan(client, load_plan(name))
            wanted = RunWanted(
                plan=name,
                bench=self.bench,
                values=self.values,
                confirmed_by=self.confirmed_by,
                accept_expired=self.accept_expired,
                key=secrets.token_hex(16),
            )
            return client.queue(wanted)
        except RefusedError as error:
            if error.status in OURS:
                raise BadInputError(error.what, where=error.where, fix=error.fix) from error
            raise
        except ValueError as error:
            raise BadInputError(f"the service rejects it: {str(error)[:300]}") from error


@dataclass
class _Watching:
    """Follows a run until it is over, and passes on what its operator says here."""

    client: Client
    run: RunData
    stop: StopRequest
    told_stop: bool = False
    shown: str = ""
    terminal: StandardTerminal | None = field(default_factory=operators_terminal)
    typed: queue.SimpleQueue[str] = field(default_factory=queue.SimpleQueue)

    def until_over(self) -> RunData:
        """The run as it ended.

        Raises:
            BenchError: the service has not answered for a minute.
            InterruptError: somebody asked twice to stop.
        """
        retry = Retry()
        if self.terminal is not None:
            threading.Thread(target=self._read_keys, args=(self.terminal,), daemon=True).start()
        keys = f" ({KEYS})" if self.terminal is not None else ""
        with progress(f"run {self.run.id}: {self.run.plan} on {self.run.bench}{keys}") as show:
            while self.run.state not in OVER:
                retry.ask(self._look)
                show(self.run.doing or self.run.state.replace("_", " "), self.run.share)
                time.sleep(_LOOK_S)
        return self.run

    def _look(self) -> None:
        self._speak()
        self.run = self.client.run(self.run.id)

    def _speak(self) -> None:
        if self.stop.times > 1:
            raise InterruptError(
                f"interrupted; run {self.run.id} is being stopped by the service", where=f"run {self.run.id}"
            )
        if self.stop.times and not self.told_stop:
            self._ask("q")
            self.told_stop = True
        if self.terminal is None:
            return
        if self.run.message and self.run.message != self.shown:
            self.shown = self.run.message
            self.terminal.tell(self.shown)
        while not self.typed.empty():
            self._ask(self.typed.get())

    def _read_keys(self, terminal: StandardTerminal) -> None:
        """In a thread of its own: an emergency stop does not wait until the service says how the run is."""
        while self.run.state not in OVER:
            for line in terminal.typed():
                if line.strip().lower() == EMERGENCY:
                    self._stop_in_emergency()
                else:
                    self.typed.put(line)
            time.sleep(_KEYS_S)

    def _stop_in_emergency(self) -> None:
        try:
            self.client.stop_in_emergency(self.run.bench)
        except RefusedError:
            pass  # the bench is not there any more
        except BenchError as error:
            complain("error", f"the service has NOT accepted the emergency stop: {error}")

    def _ask(self, line: str) -> None:
        """What the keys of `hil run` mean, over the API; what is too late is no mistake."""
        run = self.run.id
        known: dict[str, Callable[[], object]] = {
            "p": lambda: self.client.pause(run),
            "r": lambda: self.client.resume(run),
            "q": lambda: self.client.abort(run),
        }
        with contextlib.suppress(RefusedError):
            known.get(line.strip().lower(), lambda: self.client.answer(run, line.strip()))()


def _brought(client: Client, run: RunData, place: ResultsFolder, tell: Tell) -> int:
    """The run's files, here; its exit code."""
    for name in [one for one in run.files if one in NAMES]:
        client.download(run.id, name, place.folder / name)
    place.remove_stale(run.files)
    if run.reason:
        complain("error", run.reason)
    if RESULT in run.files:
        result = RunResult.model_validate_json((place.folder / RESULT).read_bytes())
        tell(result, place.folder)
    if run.state == "cancelled":
        return InterruptError.exit_code
    return BenchError.exit_code if run.exit_code is None else run.exit_code
