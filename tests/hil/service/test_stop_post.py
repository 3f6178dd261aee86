"""What the stop post takes for a stop, who gives way, and what is left of stops that are repeated."""

from __future__ import annotations

import hashlib
import http.client
import json
import queue
import time
from http import HTTPStatus
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest

from hil.execution.benches import Bench
from hil.service.connection_limit import ConnectionLimit
from hil.service.stop_post._answering import Answering, Asked, RefusedError
from hil.service.stop_post._latches import Latched, Latches
from hil.service.stop_post._messages import OwnBench, Owner
from tests.hil.service.served import Served, served

ANNA = "hil_secret"
OWNERS = {
    hashlib.sha256(ANNA.encode()).hexdigest(): Owner(name="anna", role="operator"),
    hashlib.sha256(b"old").hexdigest(): Owner(name="bert", role="viewer", until_s=1.0),
}


def answering(*hosts: str, proxies: tuple[str, ...] = ()) -> Answering:
    return Answering(frozenset(hosts or ("bench",)), frozenset(proxies), OWNERS)


def head(path: str = "/api/v1/benches/sim/emergency-stop", method: str = "POST", **headers: str) -> bytes:
    named = {"Host": "bench:8081"} | {name.replace("_", "-"): value for name, value in headers.items()}
    lines = [f"{method} {path} HTTP/1.1", *(f"{name}: {value}" for name, value in named.items())]
    return "\r\n".join(lines).encode()


@pytest.mark.parametrize(
    ("request_", "bench", "by", "way"),
    [
        (head(), "sim", "somebody at 10.0.0.7", "api"),
        (head("/api/v1/emergency-stop"), None, "somebody at 10.0.0.7", "api"),
        (head(Authorization=f"Bearer {ANNA}"), "sim", "anna", "api"),
        (head(Cookie=f"a=b; hil_session={ANNA}", Origin="http://bench:8080"), "sim", "anna", "page"),
        (head(Authorization="Bearer old"), "sim", "somebody at 10.0.0.7", "api"),
        (head(Authorization="Bearer \xff"), "sim", "somebody at 10.0.0.7", "api"),
        (head(Cookie='"broken'), "sim", "somebody at 10.0.0.7", "api"),
    ],
)
def test_nobody_is_refused_a_stop_and_who_says_so_is_named(
    request_: bytes, bench: str | None, by: str, way: str
) -> None:
    asked = answering().asked(request_, "10.0.0.7")
    assert asked is not None
    assert (asked.bench, asked.by, asked.origin, asked.way) == (bench, by, "10.0.0.7", way)


@pytest.mark.parametrize(
    ("request_", "status"),
    [
        (head("/api/v1/runs"), HTTPStatus.NOT_FOUND),
        (head("/api/v1/benches/../emergency-stop"), HTTPStatus.NOT_FOUND),
        (head(method="DELETE"), HTTPStatus.METHOD_NOT_ALLOWED),
        (head(Origin="http://evil.example"), HTTPStatus.FORBIDDEN),
        (head(Origin="null"), HTTPStatus.FORBIDDEN),
        (head(Host="evil.example"), HTTPStatus.MISDIRECTED_REQUEST),
        (b"\x16\x03\x01\x02\x00", HTTPStatus.MISDIRECTED_REQUEST),
        (b"", HTTPStatus.MISDIRECTED_REQUEST),
    ],
)
def test_what_is_no_stop_or_comes_from_another_site_is_refused(request_: bytes, status: HTTPStatus) -> None:
    with pytest.raises(RefusedError) as refused:
        answering().asked(request_, "10.0.0.7")
    assert refused.value.status == status


def test_a_look_is_no_stop_and_only_a_trusted_proxy_says_for_whom_it_asks() -> None:
    assert answering().asked(head(method="OPTIONS"), "10.0.0.7") is None
    assert answering().asked(head(method="GET"), "10.0.0.7") is None
    request = head(X_Forwarded_For="1.2.3.4, 10.9.9.9")
    assert _asked(answering().asked(request, "10.0.0.7")).origin == "10.0.0.7"
    assert _asked(answering(proxies=("10.0.0.7",)).asked(request, "10.0.0.7")).origin == "10.9.9.9"
    assert _asked(answering("*").asked(head(Host="any"), "10.0.0.7")).bench == "sim"


def test_of_whom_most_are_the_longest_silent_gives_way() -> None:
    crowd: ConnectionLimit[str] = ConnectionLimit(4)
    for name, address in (("a1", "a"), ("b1", "b"), ("a2", "a"), ("a3", "a")):
        assert crowd.give_way(address) == (True, None)
        crowd.add(name, address)
    assert crowd.give_way("c") == (True, "a1")
    crowd.heard("a1")
    assert crowd.give_way("c") == (True, "a2")
    for name in ("a2", "a3", "b1"):
        crowd.heard(name)
    assert crowd.give_way("c") == (False, None)  # all are being answered
    crowd.silent("b1")
    assert crowd.give_way("c") == (True, "b1")
    crowd.remove("a1")
    assert (crowd.give_way("c"), len(crowd)) == ((True, None), 3)


def test_one_address_does_not_hold_all_unless_it_is_a_proxy() -> None:
    crowd: ConnectionLimit[int] = ConnectionLimit(10, 2, frozenset({"proxy"}))
    for number in range(2):
        crowd.add(number, "a")
        crowd.add(10 + number, "proxy")
    assert crowd.give_way("a") == (True, 0)
    assert crowd.give_way("b") == (True, None)
    assert crowd.give_way("proxy") == (True, None)
    crowd.heard(0)
    crowd.heard(1)
    assert crowd.give_way("a") == (False, None)


@pytest.mark.slow
def test_the_stop_post_alone_latches_a_free_bench_where_its_service_looks(tmp_path: Path) -> None:
    """Stops of a simulated bench lie in the folder of its service: one latched elsewhere holds nothing up."""
    with served(tmp_path / "data", "--rate", "1000", state=tmp_path / "state") as service:
        stop_url = service.get("/health")["stop_url"]
        for _ in range(2):
            assert _stopped(stop_url)[0] == 200
            _until(lambda: service.get("/benches/sim")["state"] == "emergency_stop")
            service.post("/benches/sim/reset")
            _until(lambda: service.get("/benches/sim")["state"] != "emergency_stop")


@pytest.mark.parametrize("folder", ["", "stops"], ids=["hardware", "simulated"])
def test_a_latch_that_failed_is_tried_again_at_the_next_stop(folder: str, tmp_path: Path) -> None:
    """A file where the folder of stops has to be: that stop is reported as not latched, the next one is."""
    done: queue.SimpleQueue[Latched] = queue.SimpleQueue()
    latches = Latches(done.put)
    stops = tmp_path / "stops" if folder else None
    latches.know({"sim": OwnBench(file="sim", stops=str(stops or ""))})
    asked = Asked("sim", "anna", "operator", "10.0.0.7", "api", 0.0)
    bench = Bench("sim", stops)
    if stops is not None:
        stops.write_text("in the way")
        latches.latch("sim", asked, Path())
        assert done.get(timeout=10.0).problem
        stops.unlink()
    latches.latch("sim", asked, Path())
    assert not done.get(timeout=10.0).problem
    assert "anna" in bench.stopped()
    bench.reset("anna")


@pytest.mark.slow
def test_a_stop_that_is_repeated_leaves_one_latch_and_one_row(tmp_path: Path) -> None:
    with served(tmp_path / "data", "--rate", "1000", state=tmp_path / "state") as service:
        stop_url = service.get("/health")["stop_url"]
        for url in (service.url, stop_url) * 15:
            assert _stopped(url)[0] == 200
        _until(lambda: service.get("/benches/sim")["state"] == "emergency_stop")
        rows = _until(lambda: [one for one in service.get("/audit") if one["action"] == "emergency stop"])
        assert [(one["who"], one["detail"]) for one in rows] == [
            ("somebody at 127.0.0.1", "from 127.0.0.1, api")
        ]
        latches = list((tmp_path / "data" / "emergency-stops").glob("*.json"))
        assert [json.loads(path.read_text())["origin"] for path in latches] == ["127.0.0.1"]
        service.post("/benches/sim/reset")
        status, answer = _stopped(stop_url, {"Origin": service.url})
        assert (status, answer["stopped"]) == (200, [{"bench": "sim", "run": None}])
        rows = _until(lambda: _rows(service, 2))
        assert rows[0]["detail"] == "from 127.0.0.1, page"


@pytest.mark.slow
def test_the_page_may_send_to_the_stop_post_and_no_other_site_may(tmp_path: Path) -> None:
    with served(tmp_path / "data", state=tmp_path / "state") as service:
        stop_url = service.get("/health")["stop_url"]
        where = urlsplit(service.url)
        connection = http.client.HTTPConnection(where.hostname or "", where.port, timeout=30)
        connection.request("GET", "/")
        policy = connection.getresponse().headers["content-security-policy"]
        connection.close()
        assert f"connect-src 'self' {stop_url}" in policy
        assert _stopped(stop_url, {"Origin": "http://evil.example"})[0] == 403
        assert service.get("/benches/sim")["state"] == "free"


def _asked(asked: Asked | None) -> Asked:
    assert asked is not None
    return asked


def _stopped(url: str, headers: dict[str, str] | None = None) -> tuple[int, Any]:
    where = urlsplit(url)
    connection = http.client.HTTPConnection(where.hostname or "", where.port, timeout=30)
    try:
        connection.request("POST", "/api/v1/benches/sim/emergency-stop", headers=headers or {})
        answer = connection.getresponse()
        return answer.status, json.loads(answer.read())
    finally:
        connection.close()


def _rows(service: Served, count: int) -> Any:
    rows = [one for one in service.get("/audit") if one["action"] == "emergency stop"]
    return rows if len(rows) >= count else None


def _until(found: Any) -> Any:
    until_s = time.monotonic() + 30
    while not (what := found()):
        assert time.monotonic() < until_s
        time.sleep(0.05)
    return what
