"""Carries a case out: a process in a folder of its own, with a time limit."""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import signal
import subprocess
import time
import xml.etree.ElementTree as ET
from pathlib import Path

from hil.core.errors import HilError
from hil.core.recording import read_frames, read_recording
from tests.bad_inputs.case import Case, Interruption, Outcome
from tests.bad_inputs.inputs import HIL, copy_inputs

LIMIT_S = 60.0
_POLL_S = 0.005
_SIGNALS = "INT,TERM,HUP,QUIT"
_LARGEST_HASHED = 1 << 28
_LONGEST_OUTPUT = 2_000_000


def execute(case: Case, inputs: Path, folder: Path) -> Outcome:
    """Try a case in `folder`, which is removed afterwards."""
    work = folder / "work"
    copy_inputs(inputs, work)
    if case.prepare:
        case.prepare(work)
    before = _contents(work)
    try:
        code, out, err, seconds, megabytes = _process(case, work, folder)
        after = _contents(work)
        new = tuple(sorted(after.keys() - before.keys()))
        changed = tuple(sorted(name for name in before if after.get(name) != before[name]))
        broken = tuple(name for name in new if (work / name).is_file() and not _is_whole(work / name))
        return Outcome(code, out, err, new, changed, broken, seconds, megabytes)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _process(case: Case, work: Path, folder: Path) -> tuple[int | None, str, str, float, float]:
    """Exit code, what was printed, seconds, and the largest resident memory in MB."""
    line = [HIL, *(case.command.split() if case.command != "hil" else []), *case.arguments]
    if case.interruption:  # whoever tries this may ignore signals (nohup); a user's terminal does not
        line = ["env", f"--default-signal={_SIGNALS}", *line]
    if case.shell:
        line = ["bash", "-c", case.shell, "bash", *line]
    environment = {k: v for k, v in os.environ.items() if k not in ("COLUMNS", "LC_ALL", "NO_COLOR")}
    with (folder / "out").open("wb") as out, (folder / "err").open("wb") as err:
        process = subprocess.Popen(
            line,
            cwd=work,
            stdin=subprocess.DEVNULL,
            stdout=out,
            stderr=err,
            env=environment | case.environment,
            start_new_session=True,
        )
        began_s = time.monotonic()
        if case.interruption:
            _interrupt(process, case.interruption, work)
        code, megabytes = _waited(process)
        seconds = time.monotonic() - began_s
    return code, _text(folder / "out"), _text(folder / "err"), seconds, megabytes


def _waited(process: subprocess.Popen[bytes]) -> tuple[int | None, float]:
    """Exit code and the largest memory in MB; no code of one that had to be ended after the time limit.

    What `wait4` says of a process counts in what its parent had. Where that is more, the memory that was read
    while it ran counts.
    """
    if process.returncode is not None:  # a signal found it ended
        return process.returncode, 0.0
    until_s, read = time.monotonic() + LIMIT_S, 0.0
    hung = False
    while True:
        read = max(read, _megabytes(process.pid))
        ended, status, usage = os.wait4(process.pid, os.WNOHANG)
        if ended:
            process.returncode = os.waitstatus_to_exitcode(status)
            whole = usage.ru_maxrss / 1e3
            megabytes = whole if whole > _megabytes(os.getpid()) else read
            return None if hung else process.returncode, megabytes
        if not hung and time.monotonic() > until_s:
            hung = True
            os.killpg(process.pid, signal.SIGKILL)  # its own session: started here
        time.sleep(_POLL_S)


def _megabytes(pid: int) -> float:
    """The most that a process has had so far; 0 of one that has ended."""
    try:
        status = Path(f"/proc/{pid}/status").read_text()
    except OSError:
        return 0.0
    found = re.search(r"VmHWM:\s+(\d+) kB", status)
    return float(found[1]) / 1e3 if found else 0.0


def _interrupt(process: subprocess.Popen[bytes], what: Interruption, work: Path) -> None:
    start = time.monotonic()
    while process.poll() is None and time.monotonic() - start < LIMIT_S:
        there = not what.when_there or (work / what.when_there).exists()
        if there and time.monotonic() - start >= what.after_s:
            break
        time.sleep(_POLL_S)
    for name in what.names:
        if process.poll() is None:
            process.send_signal(getattr(signal, name))
            time.sleep(_POLL_S)


def _text(path: Path) -> str:
    return path.read_bytes()[:_LONGEST_OUTPUT].decode("utf-8", errors="replace")


def _contents(folder: Path) -> dict[str, str]:
    """What every path below a folder holds, by its hash."""
    found = {}
    for path in sorted(folder.rglob("*")):
        if path.is_symlink():
            what = f"link to {path.readlink()}"
        else:
            what = _content(path) if path.is_file() else "directory"
        found[str(path.relative_to(folder))] = what
    return found


def _content(path: Path) -> str:
    if path.stat().st_size > _LARGEST_HASHED:
        return f"{path.stat().st_size} bytes"
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _is_whole(path: Path) -> bool:
    content = path.read_bytes()
    try:
        match path.suffix:
            case ".json":
                json.loads(content)
            case ".xml" | ".svg":
                ET.fromstring(content)
            case ".html":
                return content.rstrip().endswith(b"</html>")
            case ".pdf":
                return content.rstrip().endswith(b"%%EOF")
            case ".mcap":
                return _is_readable(path)
            case ".csv":
                return content.endswith(b"\n")
    except (ValueError, ET.ParseError):
        return False
    return bool(content)


def _is_readable(path: Path) -> bool:
    """Whether a recording can be opened; one that was stopped at the start may have no samples."""
    for read in (lambda: read_recording(path, allow_missing=True), lambda: read_frames(path)):
        try:
            read()
            return True
        except HilError:
            continue
    return False
