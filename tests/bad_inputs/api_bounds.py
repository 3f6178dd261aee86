"""Each route of the API that takes a body, with bodies too large, too deep, too long or of too many keys."""

from __future__ import annotations

import json
import re
import tempfile
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from hil.service.api import openapi_text
from tests.hil.service.served import Served, served

_LARGE_BYTES, _LONG, _DEPTH, _MANY = 3_000_000, 200_000, 100_000, 20_000
#: Of the service and of what it began to read with, beyond what they had before, MB.
MOST_MEGABYTES = 300.0


@dataclass(frozen=True)
class RouteTried:
    """What a route answered to each kind of body, how long the slowest took, and what the service grew by."""

    method: str
    path: str
    statuses: dict[str, int]
    slowest_s: float
    megabytes: float

    @property
    def faults(self) -> list[str]:
        """What is wrong with it: an answer that is no refusal, or too much memory."""
        wrong = [f"{what}: {status}" for what, status in self.statuses.items() if not 400 <= status < 500]
        grown = [f"grew by {self.megabytes:.0f} MB"] if self.megabytes > MOST_MEGABYTES else []
        return [f"{self.method} {self.path}: {text}" for text in (*wrong, *grown)]


def try_routes() -> Iterator[RouteTried]:
    """Each route in turn, on one service with a simulated bench."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        with served(folder / "data", "--rate", "100000", state=folder / "state") as service:
            # A process with its libraries reads what people give; from now on it is there.
            _status(service, "PUT", "/api/v1/controllers/1", "application/toml", b"a = 1")
            for method, path, kind in _routes():
                before = _megabytes(service)
                found = {what: _status(service, method, path, kind, body()) for what, body in _bodies(kind)}
                yield RouteTried(
                    method,
                    path,
                    {what: status for what, (status, _) in found.items()},
                    max(seconds for _, seconds in found.values()),
                    _megabytes(service) - before,
                )


def table_of(tried: list[RouteTried]) -> str:
    """For docs/reference/bounds.md."""
    kinds = ("too large", "too deep", "too long", "too many")
    head = f"| route | {' | '.join(kinds)} | slowest, s | memory, MB |\n|---|---|---|---|---|---|---|\n"
    return head + "".join(
        f"| `{one.method} {one.path}` | {' | '.join(str(one.statuses[kind]) for kind in kinds)} "
        f"| {one.slowest_s:.1f} | {one.megabytes:+.0f} |\n"
        for one in tried
    )


def _routes() -> Iterator[tuple[str, str, str]]:
    """Method, path with its parameters filled in, and type of the body."""
    for path, operations in json.loads(openapi_text())["paths"].items():
        for method, operation in operations.items():
            for kind in operation.get("requestBody", {}).get("content", {}):
                yield method.upper(), re.sub(r"\{[^}]*\}", "1", path), kind


def _bodies(kind: str) -> list[tuple[str, Callable[[], bytes]]]:
    toml, yaml = "toml" in kind, "yaml" in kind
    deep = f"a{'.a' * _DEPTH} = 1" if toml else f"a: {'[' * _DEPTH}" if yaml else "[" * _DEPTH
    return [
        ("too large", lambda: b" " * _LARGE_BYTES),
        ("too deep", lambda: deep.encode()),
        ("too long", lambda: _named("title", json.dumps("x" * _LONG), toml=toml, yaml=yaml).encode()),
        ("too many", lambda: _many(toml=toml, yaml=yaml).encode()),
    ]


def _named(key: str, value: str, *, toml: bool, yaml: bool) -> str:
    return f"{key} = {value}" if toml else f"{key}: {value}" if yaml else f'{{"{key}": {value}}}'


def _many(*, toml: bool, yaml: bool) -> str:
    if toml or yaml:
        return "\n".join(f"k{number}{' =' if toml else ':'} 1" for number in range(_MANY))
    return json.dumps({f"k{number}": number for number in range(_MANY // 2)})


def _status(service: Served, method: str, path: str, kind: str, body: bytes) -> tuple[int, float]:
    request = urllib.request.Request(service.url + path, body, {"content-type": kind}, method=method)
    began_s = time.monotonic()
    try:
        with urllib.request.urlopen(request, timeout=60) as answer:
            return answer.status, time.monotonic() - began_s
    except urllib.error.HTTPError as error:
        with error:
            return error.code, time.monotonic() - began_s
    except (urllib.error.URLError, ConnectionError):  # refused by its length before all of it was sent
        return 413, time.monotonic() - began_s


def _megabytes(service: Served) -> float:
    """The resident memory of the service and of all that it began."""
    numbers, total_kb = [service.process.pid], 0
    while numbers:
        number = numbers.pop()
        for task in Path(f"/proc/{number}/task").glob("*/children"):
            numbers += [int(child) for child in task.read_text().split()]
        found = re.search(r"VmRSS:\s+(\d+) kB", Path(f"/proc/{number}/status").read_text())
        total_kb += int(found[1]) if found else 0
    return total_kb / 1e3
