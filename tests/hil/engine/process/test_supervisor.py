"""A process that is watched, and ends, hangs or says nonsense; small processes stand in for it."""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from hil.core.errors import BadInputError, BenchError, EmergencyStopError, HilError, InterruptError
from hil.engine import RunRequest
from hil.engine.bench.bench_tables import BenchFile
from hil.engine.process import supervisor
from hil.engine.process.supervisor import execute
from tests.benches_for_tests import plan, sim_bench
from tests.operators import Silent

TURNED = '{"kind": "turned"}'
CONCLUDED = '{"kind": "concluded", "armed": true, "unsafe": UNSAFE}'
RESULT = (
    '{"verdict": "pass", "plan": "p", "bench": "b", "real_time_factor": 1, "bench_time_s": 1,'
    ' "safe_state": "confirmed"}'
)
ENDED = f'{{"kind": "ended", "result": {RESULT}, "recording": "r"}}'
REFUSED = '{"kind": "refused", "error": {"kind": "BadInputError", "what": "not this"}}'
TOLD = '{"kind": "message", "text": "hello"}'
HUNG_AFTER_S = 0.5


def watched_bench(name: str = "watched", **changes: Any) -> BenchFile:
    """A simulated bench that is held by a process of its own: no one needs to be asked whether it is safe."""
    bench = sim_bench(name, **changes)
    settings = bench.supervision.model_copy(update={"own_process": True, "hung_after_s": HUNG_AFTER_S})
    return bench.model_copy(update={"supervision": settings})


def process(*lines: str, then: str = "") -> list[str]:
    """A command that says something and then does something."""
    said = "\n".join(lines)
    return [sys.executable, "-S", "-c", f"import os, signal, sys, time\nprint({said!r}, flush=True)\n{then}"]


def request(folder: Path, **keys: Any) -> RunRequest:
    return RunRequest(plan("[{wait: {duration_s: 1}}]"), watched_bench(), folder, **keys)


def lost(folder: Path, command: list[str], **keys: Any) -> HilError:
    with pytest.raises(HilError) as caught:
        execute(request(folder, **keys), command)
    return caught.value


def test_what_it_says_is_passed_on(tmp_path: Path):
    told, shown = Silent(), []
    outcome = execute(
        request(tmp_path, terminal=told, progress=lambda share, text: shown.append((share, text))),
        process(TURNED, TOLD, '{"kind": "progress", "share": 0.5, "text": "half"}', ENDED),
    )
    assert (outcome.error, outcome.result.verdict) == (None, "pass")
    assert (told.told, shown) == (["hello"], [(0.5, "half")])


def test_a_refusal_is_raised_as_what_it_is(tmp_path: Path):
    error = lost(tmp_path, process(REFUSED))
    assert (type(error), str(error)) == (BadInputError, "not this")


@pytest.mark.parametrize(
    ("then", "said"),
    [
        ("os.kill(os.getpid(), signal.SIGKILL)", "was ended by SIGKILL"),
        ("os.abort()", "was ended by SIGABRT"),
        ("sys.exit(7)", "ended with code 7 without a message"),
        ("os.close(1); time.sleep(60)", "no longer responds"),
        ("time.sleep(60)", "hung: its loop was not running for 0.5 s"),
        ("while True: pass", "hung: its loop was not running for 0.5 s"),
        ("os.kill(os.getpid(), signal.SIGSTOP)", "hung: its loop was not running for 0.5 s|was stopped"),
    ],
)
def test_one_that_ends_or_hangs_is_given_up_in_words(then: str, said: str, tmp_path: Path):
    command = process(TURNED, then=f"open({str(tmp_path / 'pid')!r}, 'w').write(str(os.getpid()))\n{then}")
    error = lost(tmp_path, command)
    assert type(error) is BenchError
    assert error.exit_code == 3
    assert any(part in str(error) for part in said.split("|")), str(error)
    with pytest.raises(ProcessLookupError):
        os.kill(int((tmp_path / "pid").read_text()), 0)


def test_one_that_does_not_leave_when_all_is_said_is_ended(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(supervisor, "_LEAVING_S", 1.0)
    number = tmp_path / "pid"
    stays = process(ENDED, then=f"open({str(number)!r}, 'w').write(str(os.getpid()))\ntime.sleep(60)")
    assert execute(request(tmp_path), stays).result.verdict == "pass"
    with pytest.raises(ProcessLookupError):
        os.kill(int(number.read_text()), 0)


def test_one_that_stands_still_for_a_moment_is_not_given_up(tmp_path: Path):
    stands = (
        "number = os.getpid()\n"
        "if os.fork() == 0:\n"
        "    time.sleep(0.2)\n"
        "    os.kill(number, signal.SIGCONT)\n"
        "    os._exit(0)\n"
        "os.kill(number, signal.SIGSTOP)\n"
        f"print({ENDED!r}, flush=True)\n"
    )
    assert execute(request(tmp_path), process(TOLD, then=stands)).result.verdict == "pass"


def test_one_that_is_stopped_before_its_loop_turns_is_not_waited_for(tmp_path: Path):
    error = lost(tmp_path, process(TOLD, then="os.kill(os.getpid(), signal.SIGSTOP)"))
    assert "was stopped (SIGSTOP) for 0.5 s; nothing was commanded" in str(error)


def test_one_that_opens_its_bench_is_waited_for_until_somebody_asks_to_stop(tmp_path: Path):
    asked = request(tmp_path)
    began_s = time.monotonic()
    asked.progress = lambda share, text: asked.stop.ask()
    with pytest.raises(InterruptError, match="was still opening the bench"):
        execute(asked, process('{"kind": "progress", "share": 0, "text": ""}', then="time.sleep(60)"))
    assert time.monotonic() - began_s >= HUNG_AFTER_S


def test_nonsense_ends_it(tmp_path: Path):
    error = lost(tmp_path, process(TURNED, "Segmentation fault", then="sys.stdin.read()"))
    assert "cannot be understood" in str(error)


def test_what_it_read_back_before_it_was_lost_counts(tmp_path: Path):
    said = lost(tmp_path, process(TURNED, CONCLUDED.replace("UNSAFE", "[]"), then="sys.exit(1)"))
    assert "safe: confirmed" in str(said)
    said = lost(tmp_path, process(TURNED, CONCLUDED.replace("UNSAFE", '["RMCU: no"]'), then="sys.exit(1)"))
    assert "safe: not confirmed (RMCU: no)" in str(said)
    assert "hil evidence recover" not in str(said)  # nothing was recorded
    assert "cut the drives' power" in str(said)


def test_an_emergency_stop_that_it_never_heard_is_one_all_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setenv("HIL_STATE", str(tmp_path / "state"))
    terminal = Silent()
    terminal.waiting = ["e"]
    error = lost(tmp_path, process(TURNED, then="time.sleep(60)"), terminal=terminal)
    assert isinstance(error, EmergencyStopError)
    assert list((tmp_path / "state").glob("*/emergency-stops/*.json"))


def test_lines_stops_and_signs_of_life_reach_it(tmp_path: Path):
    terminal = Silent()
    terminal.waiting = ["p", "yes"]
    asked = request(tmp_path, terminal=terminal)
    asked.stop.ask()
    log = tmp_path / "log"
    read = (
        f"log = open({str(log)!r}, 'w', buffering=1)\n"
        "while True:\n"
        "    line = sys.stdin.readline()\n"
        "    log.write(line)\n"
        "    if '\"here\"' in line:\n"
        f"        print({ENDED!r}, flush=True)\n"
        "        break\n"
    )
    execute(asked, process(TURNED, then=read))
    kinds = [line.partition('"kind": "')[2].partition('"')[0] for line in log.read_text().splitlines()]
    assert kinds == ["run", "typed", "typed", "stop", "here"]


def test_its_log_is_told_as_that_of_this_process(tmp_path: Path, caplog: pytest.LogCaptureFixture):
    line = '{"kind": "logged", "logger": "hil.engine.run.run", "level": 40, "text": "TEXT", '
    line += '"traceback": "TRACE"}'
    plain = line.replace("TEXT", "plain").replace("TRACE", "")
    traced = line.replace("TEXT", "traced").replace("TRACE", "Traceback: line 7")
    shown = Silent()
    execute(request(tmp_path, terminal=shown), process(TURNED, plain, traced, ENDED))
    assert shown.told == []
    records = {
        record.getMessage(): record for record in caplog.records if record.name == "hil.engine.run.run"
    }
    assert records["plain"].levelname == "ERROR"
    assert (records["plain"].exc_info, records["plain"].exc_text) == (None, None)
    assert records["traced"].exc_text == "Traceback: line 7"


def test_a_simulated_bench_stays_in_this_process_unless_its_file_says_otherwise(tmp_path: Path):
    asked = RunRequest(plan("[{hold_speed: {speed_km_h: 0, duration_s: 0.1}}]"), sim_bench("here"), tmp_path)
    assert execute(asked, ["/bin/false"]).error is None


def test_hardware_whose_process_was_lost_is_listened_to_once_its_loop_has_turned(tmp_path: Path):
    nowhere = {"interface": "socketcan", "channel": "none9"}
    buses = {name: bus.model_copy(update=nowhere) for name, bus in sim_bench().buses.items()}
    hardware = watched_bench().model_copy(update={"simulation": None, "buses": buses})
    for said, expected in ((TOLD, "nothing was commanded"), (TURNED, "safe: not confirmed (bus 'rmcu': ")):
        asked = RunRequest(plan("[{wait: {duration_s: 1}}]"), hardware, tmp_path)
        with pytest.raises(BenchError) as caught:
            execute(asked, process(said, then="sys.exit(1)"))
        assert expected in str(caught.value)
