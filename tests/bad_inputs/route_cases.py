"""Requests with values that the API must not take: each is refused in words, with a status of the asker's."""

from __future__ import annotations

import datetime
import hashlib
import json
import re
import tempfile
import urllib.error
import urllib.request
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests.hil.service.served import SHORT, Served, served

_API = "/api/v1"
_SHIPPED = Path(__file__).parents[2] / "benches"
_MOMENT = re.compile(r"\d{4}-\d\d-\d\d \d\d:\d\d UTC")


@dataclass(frozen=True)
class Refused:
    """A request and how it was refused."""

    route: str
    tried: str
    status: int
    problem: dict[str, str]

    @property
    def faults(self) -> list[str]:
        """What is wrong with the answer: it is no refusal, has no words, or those of a library."""
        words = self.message
        foreign = [
            one for one in ("Traceback", "Value error", "Input should", "body.", "/data/") if one in words
        ]
        wrong = [f"status {self.status}"] if not 400 <= self.status < 500 else []
        wrong += [] if self.problem.get("what") else ["no words"]
        return [f"{self.route}: {self.tried}: {text}" for text in (*wrong, *foreign)]

    @property
    def message(self) -> str:
        """Where, what, and what to do."""
        where, what, fix = (self.problem.get(part, "") for part in ("where", "what", "fix"))
        return " / ".join(part for part in (f"{where}: {what}" if where else what, fix) if part)


def try_values() -> Iterator[Refused]:
    """Each request in turn, on one service with a simulated bench, a plan, a model and a recording begun."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        with served(folder / "data", "--rate", "100000", state=folder / "state") as service:
            service.give("short", SHORT)
            service.ask("PUT", f"{_API}/models/axle", _model())
            service.post("/recordings", {"name": "drive.csv", "size": 5})
            for method, path, body, tried in _requests():
                status, problem = _answer(service, method, path, body)
                yield Refused(f"{method} {path.partition('?')[0]}", tried, status, problem)


def table_of(found: list[Refused]) -> str:
    """For docs/reference/bad-inputs.md."""
    head = "| request | tried | status | message |\n|---|---|---|---|\n"
    return head + "".join(
        f"| `{one.route}` | {one.tried} | {one.status} | {_plain(one.message)} |\n" for one in found
    )


_Request = tuple[str, str, object, str]


def _requests() -> Iterator[_Request]:
    yield from _of_benches()
    yield from _of_recordings()
    yield from _of_files()
    yield from _of_people()


def _of_benches() -> Iterator[_Request]:
    path = "/benches/sim/reservations"
    good = {"begins": _moment(1), "ends": _moment(2), "reason": "endurance"}
    for change, tried in (
        ({"ends": _moment(0.5)}, "it ends before it begins"),
        ({"ends": _moment(24 * 40)}, "40 days"),
        ({"begins": "1900-01-01T00:00:00Z"}, "from 1900"),
        ({"ends": "2999-01-01T00:00:00Z"}, "until 2999"),
        ({"begins": "2026-03-01T10:00:00"}, "without a zone"),
        ({"begins": "tomorrow"}, "a word for a moment"),
        ({"reason": " "}, "no reason"),
        ({"resaon": "x"}, "a misspelt field"),
    ):
        yield "POST", path, {**good, **change}, tried
    yield "POST", "/benches/none/reservations", good, "a bench that there is not"
    yield "DELETE", f"{path}/99", None, "a reservation that there is not"
    note = {"day": _moment(0)[:10], "shift": "early", "text": "all quiet"}
    for changed, tried in (
        ({"day": "1900-01-01"}, "of 1900"),
        ({"day": "2999-01-01"}, "of 2999"),
        ({"day": "today"}, "a word for a day"),
        ({"shift": "noon"}, "a shift that there is not"),
        ({"text": ""}, "no text"),
    ):
        yield "POST", "/benches/sim/handovers", {**note, **changed}, tried


def _of_recordings() -> Iterator[_Request]:
    good = {"name": "drive.csv", "size": 5}
    for change, tried in (
        ({"size": 0}, "an empty file"),
        ({"size": 10**15}, "a petabyte"),
        ({"name": "drive.docx"}, "a kind that is none"),
        ({"name": "../drive.csv"}, "a path for a name"),
        ({"columns": ["T_req"]}, "a column of no channel"),
    ):
        yield "POST", "/recordings", {**good, **change}, tried
    other = hashlib.sha256(b"other").hexdigest()
    yield "PUT", f"/recordings/1/content?at=0&sha256={other}", b"12345", "a piece with another SHA-256"
    yield "PUT", f"/recordings/1/content?at=0&sha256={other[:9]}", b"12345", "a piece with half a SHA-256"
    yield "PUT", f"/recordings/9/content?at=0&sha256={other}", b"12345", "a recording that there is not"
    yield "POST", "/recordings/1/ending", {"sha256": other}, "its end before all of it is here"
    yield "GET", "/recordings/1/curves?channel=motor_speed_rad_s", None, "curves of one that is arriving"


def _of_files() -> Iterator[_Request]:
    wrong = "a = 1\nb c\n"
    for kind in ("models", "controllers", "bench-files"):
        yield "PUT", f"/{kind}/mine", wrong, "no TOML"
        yield "PUT", f"/{kind}/mine", b"\xff\xfe", "no text"
        yield "PUT", f"/{kind}/a%20b", _model(), "a name with a space"
    yield "PUT", "/models/mine", _model().replace("gear_ratio", "gear_ration"), "a misspelt parameter"
    yield "PUT", "/models/axle", _model() + "# changed\n", "a name that stands for another text"
    yield "PUT", "/models/three_inertia", _model(), "the name of a shipped one"
    bench = (_SHIPPED / "sim.toml").read_text("utf-8").replace('name = "sim"', 'name = "mine"')
    yield "PUT", "/bench-files/mine", bench.replace('"rmcu.dbc"', '"/etc/passwd"'), "a file elsewhere"
    yield "PUT", "/bench-files/none/service", None, "one that there is not"
    yield "DELETE", "/bench-files/sim/service", None, "a bench of the command line"
    plan, other = SHORT.replace("upper: 400", "upper: 390"), hashlib.sha256(b"other").hexdigest()
    yield "PUT", f"/plans/short?instead_of={other}", plan, "another text was saved meanwhile"
    yield "PUT", "/plans/short?instead_of=", plan, "a new plan of a name that is taken"
    yield "PUT", "/plans/short?instead_of=yesterday", plan, "no SHA-256 of what it replaces"
    yield "GET", "/versions/plan/short/9/text", None, "a version that there is not"
    yield "GET", "/versions/picture/cage.png", None, "versions of a kind that has none"


def _of_people() -> Iterator[_Request]:
    yield "POST", "/session", {"secret": "nonsense"}, "a token that there is not"
    yield "GET", "/sign-in", None, "a service without sign-in"
    yield "GET", "/sign-in/return?state=1&code=2", None, "back to a service without sign-in"
    yield "PUT", "/runs/1/tags/two%20words", None, "two words for a tag"
    yield "POST", "/runs", {"plan": "short", "bench": "sim", "values": {"torque_nm": 900}}, "a value beyond"
    wild = {"plan": "acceptance", "bench": "sim", "values": {"none": 1}}
    yield "POST", "/runs", wild, "a value of no variable"
    yield "POST", "/autotunings/envelopes", {"plan": "short"}, "neither model nor bench"


def _model() -> str:
    return (_SHIPPED / "three_inertia.toml").read_text("utf-8")


def _moment(hours: float) -> str:
    now = datetime.datetime.now(datetime.UTC).replace(microsecond=0)
    return (now + datetime.timedelta(hours=hours)).isoformat()


def _answer(service: Served, method: str, path: str, body: object) -> tuple[int, dict[str, str]]:
    kind = "application/toml" if isinstance(body, str) else "application/json"
    data: Any = body if isinstance(body, bytes) else None if body is None else json.dumps(body).encode()
    data = body.encode() if isinstance(body, str) else data
    kind = "application/octet-stream" if isinstance(body, bytes) else kind
    request = urllib.request.Request(
        f"{service.url}{_API}{path}", data, {"content-type": kind}, method=method
    )
    try:
        with urllib.request.urlopen(request, timeout=60) as answer:
            return answer.status, {}
    except urllib.error.HTTPError as error:
        with error:
            return error.code, json.loads(error.read() or b"{}")


def _plain(text: str) -> str:
    """In a cell; moments differ from run to run."""
    text = _MOMENT.sub("YYYY-MM-DD hh:mm UTC", text)
    return text.replace("\n", " / ").replace("|", "\\|").replace("<", "&lt;")
