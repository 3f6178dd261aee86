"""A run in a process of its own, on the simulated bench: what is asked, typed, stopped, and who is gone."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import time
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from hil.core.errors import BadInputError, InterruptError
from hil.core.recording import read_recording, run_of
from hil.engine import RunRequest
from hil.engine.bench.bench_file import bench_from_dict
from hil.engine.bench.bench_tables import BenchFile
from hil.engine.ipc.ipc_data import asked_of
from hil.engine.ipc.ipc_messages import (
    Concluded,
    Ended,
    Here,
    Message,
    OperatorText,
    Progressed,
    StopAsked,
    Turned,
    Typed,
)
from hil.engine.ipc.ipc_pipe import IpcPipe
from hil.engine.process.hardware_process import LAST_WORDS_S
from hil.engine.process.supervisor import execute
from hil.engine.run.arming import TURNED_S
from hil.engine.stop.stopping import held_back
from test_plans import Plan, plan_from_text
from tests.benches_for_tests import SIM
from tests.operators import Answering, Silent

HOLDER = [sys.executable, "-m", "hil.app.worker.hold"]
ASKED = """
name: asked
steps:
  - hold_speed: {speed_km_h: 2, duration_s: 0.1}
  - operator_prompt: {text: stand clear, timeout_s: 60}
finally: [{ramp_down: {duration_s: 0.1}}]
"""


def own_process(alone_after_s: float = 30.0) -> BenchFile:
    """The shipped simulated bench, held by a process of its own."""
    text = f"{SIM.text}\n[supervision]\nown_process = true\nalone_after_s = {alone_after_s}\n"
    return bench_from_dict(tomllib.loads(text), text, SIM.source)


def asked(text: str = ASKED) -> Plan:
    return plan_from_text(text, "asked.yaml", Path())


def test_a_run_with_a_prompt_passes_and_its_recording_is_there(tmp_path: Path):
    operator, shown = Answering("yes"), []
    request = RunRequest(asked(), own_process(), tmp_path, terminal=operator, operator="A")
    request.progress = lambda share, text: shown.append(text)
    outcome = execute(request, HOLDER)
    assert (outcome.error, outcome.result.safe_state) == (None, "confirmed")
    recording = read_recording(outcome.recording)
    assert recording.metadata["run"]["operator"] == "A"
    assert any(event.text == "confirmed by the operator; remark: yes" for event in recording.events)
    assert operator.told[0].startswith("stand clear")


def test_what_cannot_be_carried_out_is_refused_as_here(tmp_path: Path):
    request = RunRequest(asked().model_copy(update={"text": "name: x\nsteps: []\n"}), own_process(), tmp_path)
    with pytest.raises(BadInputError, match="a plan needs at least one step"):
        execute(request, HOLDER)


@contextlib.contextmanager
def held(request: RunRequest) -> Iterator[tuple[subprocess.Popen[bytes], IpcPipe]]:
    """A process that has been asked for a run, and the command's end of its pipes."""
    process = subprocess.Popen(
        HOLDER, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True
    )
    assert process.stdin is not None
    assert process.stdout is not None
    pipe = IpcPipe(os.dup(process.stdout.fileno()), os.dup(process.stdin.fileno()))
    process.stdin.close()
    process.stdout.close()
    process.stdin = process.stdout = None  # the pipe has them
    pipe.send(asked_of(request))
    try:
        yield process, pipe
    finally:
        pipe.close()
        process.kill()
        process.wait()
        if process.stderr is not None:
            process.stderr.close()


def heard_until(pipe: IpcPipe, kind: type[Message], *, here: bool = True) -> list[Message]:
    """What is stated until something of a kind comes."""
    found: list[Message] = []
    until_s = time.monotonic() + 120
    while not any(isinstance(message, kind) for message in found):
        assert time.monotonic() < until_s, found
        pipe.wait(0.05)
        if here:
            pipe.send_if_idle(Here())
        found += pipe.fetch()
        assert not pipe.gone or found, "it has ended"
    return found


def prompted(folder: Path, alone_after_s: float = 30.0) -> RunRequest:
    """A run that stands at a prompt for ever, with its bench armed."""
    return RunRequest(asked(), own_process(alone_after_s), folder, terminal=Silent())


def ask_twice(process: subprocess.Popen[bytes], pipe: IpcPipe) -> None:
    """As a service manager that tells both processes: the one stop is counted once."""
    process.send_signal(signal.SIGTERM)
    pipe.send(StopAsked(times=1))


@pytest.mark.slow
@pytest.mark.parametrize(
    "ask",
    [
        lambda process, pipe: pipe.send(StopAsked(times=1)),
        lambda process, pipe: process.send_signal(signal.SIGTERM),
        lambda process, pipe: process.send_signal(signal.SIGHUP),
        ask_twice,
    ],
)
def test_asked_to_stop_from_either_side_it_ends_safe_once(
    ask: Callable[[subprocess.Popen[bytes], IpcPipe], None], tmp_path: Path, heard_hangups: None
):
    with held(prompted(tmp_path)) as (process, pipe):
        heard_until(pipe, OperatorText)
        ask(process, pipe)
        heard = heard_until(pipe, Ended)
    ended = heard[-1]
    assert isinstance(ended, Ended)
    assert isinstance(ended.error.as_error(), InterruptError)
    assert ended.result.safe_state == "confirmed"
    assert ended.result.end_steps.startswith("executed: ramp_down")
    assert sum(isinstance(message, Concluded) for message in heard) == 1


@pytest.mark.slow
@pytest.mark.parametrize("how", ["gone", "frozen"])
def test_a_command_that_is_gone_or_frozen_ends_the_run_in_the_normal_way(how: str, tmp_path: Path):
    with held(prompted(tmp_path, alone_after_s=0.5)) as (process, pipe):
        heard_until(pipe, OperatorText)
        if how == "gone":
            pipe.close()
        _, said = process.communicate(timeout=60 + LAST_WORDS_S)
    result = run_of(read_recording(tmp_path / "recording.mcap"))
    assert result is not None
    assert (result.verdict, result.safe_state) == ("error", "confirmed")
    assert result.end_steps.startswith("executed: ramp_down")
    words = "the command of this run has ended" if how == "gone" else "the command has been silent for"
    assert words in result.reason
    assert b"Traceback" not in said
    if how == "gone":
        assert b"safe state confirmed" in said


@pytest.mark.slow
def test_the_loop_says_that_it_turns(tmp_path: Path):
    text = "name: long\nsteps: [{hold_speed: {speed_km_h: 1, duration_s: 20}}]\n"
    with held(RunRequest(asked(text), own_process(), tmp_path)) as (_, pipe):
        heard = heard_until(pipe, Concluded)
    turns = sum(isinstance(message, Turned) for message in heard)
    assert turns > 0.5 * 20 / TURNED_S
    assert any(isinstance(message, Progressed) for message in heard)


def test_a_command_that_asks_for_nothing_is_not_waited_for():
    process = subprocess.run(HOLDER, stdin=subprocess.DEVNULL, capture_output=True, check=True, timeout=60)
    assert (process.stdout, process.stderr) == (b"", b"")


def test_a_signal_that_comes_before_it_can_answer_is_answered_later(tmp_path: Path):
    with held_back():
        manager = held(prompted(tmp_path))
        process, pipe = manager.__enter__()
    try:
        process.send_signal(signal.SIGTERM)
        ended = heard_until(pipe, Ended)[-1]
    finally:
        manager.__exit__(None, None, None)
    assert isinstance(ended, Ended)
    assert ended.error.kind == "InterruptError"


def test_what_is_typed_before_it_has_started_is_heard(tmp_path: Path):
    with held(prompted(tmp_path)) as (_, pipe):
        pipe.send(Typed(line="q"))
        ended = heard_until(pipe, Ended)[-1]
    assert isinstance(ended, Ended)
    assert ended.error.kind == "InterruptError"
