"""The real service in a process of its own, and what a program says to it."""

from __future__ import annotations

import contextlib
import json
import os
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

HIL = (sys.executable, "-c", "from hil.cli import main; main()")

#: `make service-stores` has the service on PostgreSQL.
ON_POSTGRESQL = os.environ.get("HIL_SERVICE_DATABASE") == "postgresql"
new_database: Callable[[], str] = str
_databases: dict[Path, str] = {}

#: A run of about a second and a half on the simulated bench.
SHORT = """
name: short
variables:
  torque_nm: {default: 100, unit: N m, lower: 0, upper: 200}
steps:
  - set_controller: {file: phase_stabilization.toml}
  - hold_speed: {speed_km_h: 0, duration_s: 0.2}
  - step: {segment: s, quantity: driving_torque, from_nm: 0, to_nm: $torque_nm, before_s: 0.2, after_s: 1}
finally:
  - ramp_down: {duration_s: 0.2}
criteria:
  - {segment: s, metric: peak_shaft_torque, upper: 400, unit: N m}
"""
#: One that waits for a person after its first segment.
ASKING = SHORT.replace("name: short", "name: asking").replace(
    "finally:", "  - operator_prompt: {text: 'Is the cage shut?'}\nfinally:"
)


class RefusedError(Exception):
    """An answer that is no success."""

    def __init__(self, status: int, problem: Any) -> None:
        super().__init__(f"{status}: {problem}")
        self.status, self.problem = status, problem


class Served:
    """A service that answers at `url`."""

    def __init__(self, process: subprocess.Popen[str], url: str, data: Path, token: str = "") -> None:
        self.process, self.url, self.data, self.token = process, url, data, token

    def ask(self, method: str, path: str, body: object = None, *, token: str | None = None) -> Any:
        """The answer, as JSON if it is that; raises RefusedError."""
        data = body.encode() if isinstance(body, str) else None if body is None else json.dumps(body).encode()
        headers = {"content-type": "application/yaml" if isinstance(body, str) else "application/json"}
        secret = self.token if token is None else token
        if secret:
            headers["authorization"] = f"Bearer {secret}"
        request = urllib.request.Request(self.url + path, data, headers, method=method)
        try:
            with urllib.request.urlopen(request, timeout=30) as answer:
                content, kind = answer.read(), answer.headers.get_content_type()
        except urllib.error.HTTPError as error:
            with error:
                content = error.read()
            raise RefusedError(error.code, json.loads(content) if content else None) from None
        return json.loads(content) if kind == "application/json" and content else content

    def get(self, path: str) -> Any:
        return self.ask("GET", f"/api/v1{path}")

    def post(self, path: str, body: object = None) -> Any:
        return self.ask("POST", f"/api/v1{path}", body)

    def give(self, name: str, text: str) -> Any:
        return self.ask("PUT", f"/api/v1/plans/{name}", text)

    def queue(self, plan: str = "short", bench: str = "sim", **more: object) -> int:
        return int(self.post("/runs", {"plan": plan, "bench": bench, **more})["id"])

    def until(self, run: int, wanted: Callable[[Any], bool], within_s: float = 240.0) -> Any:
        """The run once it is as wanted."""
        until_s = time.monotonic() + within_s
        while not wanted(found := self.get(f"/runs/{run}")):
            assert time.monotonic() < until_s, found
            time.sleep(0.05)
        return found

    def over(self, run: int) -> Any:
        return self.until(run, lambda found: found["state"] in ("ended", "interrupted", "cancelled"))


def environment_of(data: Path) -> dict[str, str]:
    """That of commands for a service; each service keeps its database when it is started again."""
    if data not in _databases:
        _databases[data] = new_database()
    return {**os.environ, "HIL_DATABASE": _databases[data]}


def told_by(process: subprocess.Popen[str]) -> Any:
    """What a service or an agent says with --json once it is ready."""
    assert process.stdout is not None
    told = ""
    while not told.endswith("}\n"):
        line = process.stdout.readline()
        assert line, "the process has ended"
        told += line
    return json.loads(told)


def ended(process: subprocess.Popen[str]) -> None:
    """End a process that was not killed meanwhile, and let go of it."""
    if process.poll() is None:
        process.terminate()
    process.wait(60)
    if process.stdout is not None:
        process.stdout.close()


@contextlib.contextmanager
def served(
    data: Path,
    *arguments: str,
    state: Path | None = None,
    token: str = "",
    through: tuple[str, ...] = (),
) -> Iterator[Served]:
    """Start it, `through` a command that starts it, and end it; it may be killed meanwhile."""
    environment = environment_of(data)
    if state is not None:
        environment["HIL_STATE"] = str(state)
    command = [*through, *HIL, "serve", "--data", str(data), "--port", "0", "--json", *arguments]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment)
    try:
        yield Served(process, told_by(process)["url"], data, token)
    finally:
        ended(process)
