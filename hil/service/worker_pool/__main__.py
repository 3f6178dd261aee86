"""`python -m hil.service.worker_pool`: answers the service's questions until there are none."""

from __future__ import annotations

import contextlib
import importlib
import json
import logging
import os
import select
import signal
import sys
from collections.abc import Callable, Iterator
from typing import Any

from hil.core.errors import BadInputError, HilError
from hil.service.worker_pool._worker_pool import ANSWERED, READING, REFUSED

_IDLE_S = 600.0
#: Each in its module, which is imported when it is asked for first: not every worker does everything.
TASKS = {
    "comparison": "_comparing:comparison",
    "traces": "_comparing:traces",
    "best_run": "_best_run:best",
    "run_overview": "_viewing:overview",
    "run_spectrum": "_viewing:spectrum",
    "run_samples": "_viewing:samples",
    "draft": "_designing:draft",
    "design": "_designing:designed",
    "cloud": "_cloud:cloud",
    "segments": "_segments:segments",
    "fitted": "_fitted:fitted",
    "envelope": "_tuning:envelope",
    "campaign": "_campaigning:given",
    "campaign_so_far": "_campaigning:so_far",
    "campaign_findings": "_campaign_findings:findings",
    "campaign_car": "_campaign_car:files",
    "campaign_table": "_campaigning:table",
    "read_plan": "plan_reading:plan",
    "read_model": "plan_reading:model",
    "read_controller": "plan_reading:controller",
    "recording_measured": "recording_curves:measured",
    "recording_simulated": "recording_curves:simulated",
    "read_file": "file_checking:file",
    "read_recording": "recording_reading:recording",
    "schema": "plan_reading:schema",
    "campaign_examples": "_campaigning:examples",
}


def main() -> None:
    """Answer line by line; end with the service, or after ten minutes without a question."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what a library prints is no answer
    while select.select([0], [], [], _IDLE_S)[0]:
        line = sys.stdin.buffer.readline()
        if not line:
            return
        answers.write(_answer(json.loads(line)) + b"\n")
        answers.flush()


def _answer(question: dict[str, Any]) -> bytes:
    try:
        with _limited(question["task"], question["read_within_s"]):
            return ANSWERED + _json(_task(question["task"])(**question["asked"]))
    except HilError as error:
        bad = isinstance(error, BadInputError)
        return _refusal(error.what, error.where, error.fix, bad_input=bad)
    except Exception as error:
        logging.getLogger(__name__).exception("internal error")
        what = f"internal error: {type(error).__name__}: {error}"
        return _refusal(what, question["task"], "please report it", bad_input=False)


def _task(name: str) -> Callable[..., dict[str, Any]]:
    module, _, function = TASKS[name].partition(":")
    found: Callable[..., dict[str, Any]] = getattr(
        importlib.import_module(f"{__package__}.{module}"), function
    )
    return found


@contextlib.contextmanager
def _limited(task: str, read_within_s: float) -> Iterator[None]:
    """Of what people give, reading takes so much of a processor; the system ends this process after that."""
    if task.startswith(READING):
        signal.setitimer(signal.ITIMER_VIRTUAL, read_within_s)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)


def _refusal(what: str, where: str, fix: str, *, bad_input: bool) -> bytes:
    return REFUSED + _json({"what": what, "where": where, "fix": fix, "bad_input": bad_input})


def _json(value: dict[str, Any]) -> bytes:
    return json.dumps(value, allow_nan=False, separators=(",", ":")).encode()


if __name__ == "__main__":
    main()
