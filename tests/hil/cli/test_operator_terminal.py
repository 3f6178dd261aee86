"""An operator at a pseudo-terminal: prompts, pauses, ends; also with a bench in another process."""

from __future__ import annotations

import contextlib
import json
import os
import pty
import select
import signal
import subprocess
import termios
from collections.abc import Iterator
from pathlib import Path

import pytest

from hil.cli.streams import StandardTerminal, operators_terminal
from hil.core.recording import read_recording
from tests.benches_for_tests import SIM
from tests.hil.cli.test_commands import HIL
from tests.hil.cli.test_sim_bench import MOST_REPEATS, serving

PROMPT = """
name: asked
steps:
  - hold_speed: {speed_km_h: 2, duration_s: 0.2}
  - operator_prompt: {text: "Is the cage shut?", timeout_s: TIMEOUT}
  - wait: {duration_s: AFTER}
finally: [{ramp_down: {duration_s: 0.2}}]
"""


class Operator:
    """Who sits at the terminal of a `hil run`."""

    def __init__(self, folder: Path, text: str, *options: object) -> None:
        (folder / "asked.yaml").write_text(text)
        self._own, theirs = pty.openpty()
        command = [HIL, "run", "asked.yaml", "--out", "out", "--overwrite", "--json", *options]
        self.run = subprocess.Popen(
            list(map(str, command)), cwd=folder, stdin=theirs, stderr=theirs, stdout=subprocess.PIPE,
            start_new_session=True, preexec_fn=take_terminal,
        )  # fmt: skip
        os.close(theirs)
        self.seen = ""

    def wait_for(self, text: str) -> None:
        while text not in self.seen:
            ready, _, _ = select.select([self._own], [], [], 120)
            assert ready, self.seen
            with contextlib.suppress(OSError):
                self.seen += os.read(self._own, 4096).decode(errors="replace")
                continue
            raise AssertionError(self.seen)

    def type(self, line: str) -> None:
        os.write(self._own, f"{line}\n".encode())

    def ended(self) -> tuple[int, dict]:  # type: ignore[type-arg]
        """Its exit code and result.json; what it shows is read, or it would wait for a reader."""
        while select.select([self._own], [], [], 120)[0]:
            try:
                data = os.read(self._own, 4096)
            except OSError:
                break
            self.seen += data.decode(errors="replace")
        out, _ = self.run.communicate(timeout=120)
        os.close(self._own)
        assert "Traceback" not in self.seen
        return self.run.returncode, json.loads(out)


def take_terminal() -> None:
    """The terminal is the new session's own, and this process in its foreground."""
    import fcntl

    fcntl.ioctl(0, termios.TIOCSCTTY, 0)


def plan(timeout_s: float = 60, after_s: float = 0.2) -> str:
    return PROMPT.replace("TIMEOUT", str(timeout_s)).replace("AFTER", str(after_s))


@pytest.mark.slow
def test_a_prompt_is_answered_and_what_is_typed_is_kept(tmp_path: Path) -> None:
    operator = Operator(tmp_path, plan())
    operator.wait_for("Is the cage shut?")
    operator.type("yes, by A. Tester")
    code, result = operator.ended()
    assert (code, result["safe_state"]) == (0, "confirmed")
    events = read_recording(tmp_path / "out" / "recording.mcap").events
    assert "confirmed by the operator; remark: yes, by A. Tester" in [
        e.text for e in events if e.kind == "prompt"
    ]


@pytest.mark.slow
def test_a_prompt_without_an_answer_ends_the_run_like_an_operators_stop(tmp_path: Path) -> None:
    code, result = Operator(tmp_path, plan(timeout_s=0.5)).ended()
    assert (code, result["safe_state"]) == (130, "confirmed")
    assert "no answer to 'Is the cage shut?' within 0.5 s" in result["reason"]
    assert result["end_steps"].startswith("executed: ramp_down")


@pytest.mark.slow
@pytest.mark.parametrize("line", ["q", "e", None])
def test_a_prompt_is_left_at_once(line: str | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HIL_STATE", str(tmp_path / "state"))
    operator = Operator(tmp_path, plan(timeout_s=3600))
    operator.wait_for("Is the cage shut?")
    if line is None:
        operator.run.send_signal(signal.SIGINT)
    else:
        operator.type(line)
    code, result = operator.ended()
    assert (code, result["safe_state"]) == (3 if line == "e" else 130, "confirmed")
    assert (result["emergency_stop"] is not None) == (line == "e")


def bench_of_its_own(folder: Path) -> Path:
    """The simulated bench, held by a process of its own as hardware is."""
    text = SIM.text
    for name in ("rmcu.dbc", "rcs_dyno.eds", "three_inertia.toml"):
        text = text.replace(f'"{name}"', f'"{SIM.source.parent / name}"')
    file = folder / "own.toml"
    file.write_text(f"{text}\n[supervision]\nown_process = true\n")
    return file


@pytest.mark.slow
@pytest.mark.parametrize(("typed", "code"), [("q", 130), ("e", 3), ("\x03", 130)])
def test_a_bench_in_a_process_of_its_own_is_led_from_the_terminal_of_its_command(
    typed: str, code: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """\\x03 is Ctrl-C as the terminal takes it: for every process in its foreground."""
    monkeypatch.setenv("HIL_STATE", str(tmp_path / "state"))
    operator = Operator(tmp_path, plan(timeout_s=3600), "--bench", bench_of_its_own(tmp_path))
    operator.wait_for("Is the cage shut?")
    operator.type(typed)
    ended, result = operator.ended()
    assert (ended, result["safe_state"]) == (code, "confirmed"), result["reason"]
    assert (result["emergency_stop"] is not None) == (typed == "e")
    assert result["end_steps"].startswith("executed" if typed != "e" else "not executed")
    assert operator.seen.count("error:") == 1
    assert "html" in result["files"]


@contextlib.contextmanager
def typed_at(own: int, text: bytes) -> Iterator[None]:
    os.write(own, text)
    assert select.select([own], [], [], 10)  # echoed: it has arrived
    yield


def test_a_terminal_gives_whole_lines_and_never_waits(monkeypatch: pytest.MonkeyPatch) -> None:
    own, theirs = pty.openpty()
    with os.fdopen(theirs, "r") as stdin:
        monkeypatch.setattr("sys.stdin", stdin)
        monkeypatch.setattr("os.tcgetpgrp", lambda descriptor: os.getpgrp())
        terminal = operators_terminal()
        assert isinstance(terminal, StandardTerminal)
        assert terminal.typed() == []
        with typed_at(own, b"p\nhalf"):
            assert terminal.typed() == ["p"]
        with typed_at(own, b" a line\n\x04"):
            assert terminal.typed() == ["half a line"]
        monkeypatch.setattr("os.tcgetpgrp", lambda descriptor: os.getpgrp() + 1)
        with typed_at(own, b"not for us\n"):
            assert terminal.typed() == []
    os.close(own)


@pytest.mark.slow
@pytest.mark.parametrize("ending", ["answer", "interrupt", "timeout"])
def test_heartbeats_go_on_while_the_operator_of_a_bench_in_another_process_thinks(
    ending: str, tmp_path: Path
) -> None:
    """Five seconds are far more than the 200 ms after which the dynos switch off by themselves."""
    timeout_s = 2.0 if ending == "timeout" else 600.0
    for _ in range(MOST_REPEATS):  # a machine that stood still is asked again
        with serving(tmp_path, "--time-scale", "0.25") as (_, file):
            operator = Operator(tmp_path, plan(timeout_s=timeout_s), "--bench", file)
            operator.wait_for("Is the cage shut?")
            if ending == "answer":
                with contextlib.suppress(subprocess.TimeoutExpired):
                    operator.run.wait(5.0)
                operator.type("")
            elif ending == "interrupt":
                operator.run.send_signal(signal.SIGINT)
            code, result = operator.ended()
        if code != 3:
            break
    assert code == (0 if ending == "answer" else 130), operator.seen
    assert result["safe_state"] == "confirmed"
    assert result["end_steps"].startswith("executed: ramp_down")


@pytest.mark.slow
def test_a_run_on_a_bench_in_another_process_is_paused_and_goes_on(tmp_path: Path) -> None:
    text = "\n".join(line for line in plan(after_s=8).splitlines() if "operator_prompt" not in line)
    for _ in range(MOST_REPEATS):
        with serving(tmp_path, "--time-scale", "0.25") as (_, file):
            operator = Operator(tmp_path, text, "--bench", file)
            operator.wait_for("p + Enter: pause")
            operator.type("p")
            operator.wait_for("held: paused by the operator")
            operator.type("r")
            code, result = operator.ended()
        if code != 3:
            break
    assert code == 0, operator.seen
    (hold,) = result["holds"]
    assert (hold["cause"], hold["ended_by"]) == ("paused by the operator", "operator")
