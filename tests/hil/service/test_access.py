"""Who may do what: every endpoint with every role, and what is refused to everybody."""

from __future__ import annotations

import http.client
import json
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest

from hil.api_schemas.api import LADDER, ROLES
from hil.service.api import openapi_text
from tests.hil.service.served import HIL, SHORT, RefusedError, Served, environment_of, served

ROOT = Path(__file__).parents[3]
#: The least role that may; "" for everybody. A new endpoint is added here, too.
LEAST = {
    ("GET", "/health"): "",
    ("GET", "/metrics"): "viewer",
    ("GET", "/benches"): "viewer",
    ("GET", "/benches/{bench}"): "viewer",
    ("POST", "/benches/{bench}/emergency-stop"): "",
    ("POST", "/emergency-stop"): "",
    ("POST", "/benches/{bench}/reset"): "engineer",
    ("PUT", "/benches/{bench}/lease"): "operator",
    ("DELETE", "/benches/{bench}/lease"): "operator",
    ("GET", "/benches/{bench}/live"): "viewer",
    ("GET", "/benches/{bench}/queue"): "viewer",
    ("GET", "/benches/{bench}/reservations"): "viewer",
    ("POST", "/benches/{bench}/reservations"): "operator",
    ("DELETE", "/benches/{bench}/reservations/{reservation}"): "operator",
    ("PUT", "/benches/{bench}/reservations/{reservation}/runs/{run}"): "operator",
    ("GET", "/benches/{bench}/handovers"): "viewer",
    ("POST", "/benches/{bench}/handovers"): "operator",
    ("DELETE", "/benches/{bench}/agent"): "engineer",
    ("GET", "/agents"): "viewer",
    ("PUT", "/agents/{agent}"): "agent",
    ("POST", "/agents/{agent}/benches/{bench}/take"): "agent",
    ("PUT", "/agents/{agent}/runs/{run}/files/{name}"): "agent",
    ("POST", "/agents/{agent}/runs/{run}/ending"): "agent",
    ("PUT", "/agents/{agent}/forecasts/{order}"): "agent",
    ("GET", "/run-list"): "viewer",
    ("GET", "/run-list/choices"): "viewer",
    ("GET", "/runs/{run}/notes"): "viewer",
    ("POST", "/runs/{run}/notes"): "operator",
    ("DELETE", "/runs/{run}/notes/{note}"): "operator",
    ("PUT", "/runs/{run}/tags/{tag}"): "operator",
    ("DELETE", "/runs/{run}/tags/{tag}"): "operator",
    ("GET", "/runs/{run}/view"): "viewer",
    ("GET", "/runs/{run}/traces"): "viewer",
    ("GET", "/runs/{run}/spectrum"): "viewer",
    ("GET", "/runs/{run}/samples"): "viewer",
    ("GET", "/layouts/{plan}"): "viewer",
    ("PUT", "/layouts/{plan}"): "viewer",
    ("GET", "/plans"): "viewer",
    ("GET", "/plans/{plan}"): "viewer",
    ("GET", "/plans/{plan}/text"): "viewer",
    ("PUT", "/plans/{plan}"): "engineer",
    ("DELETE", "/plans/{plan}"): "engineer",
    ("GET", "/kept-apart"): "viewer",
    ("GET", "/pictures"): "viewer",
    ("GET", "/pictures/{picture}"): "viewer",
    ("PUT", "/pictures/{picture}"): "engineer",
    ("DELETE", "/pictures/{picture}"): "engineer",
    ("GET", "/schemas/{kind}"): "viewer",
    ("POST", "/plan-checks"): "engineer",
    ("POST", "/forecasts"): "operator",
    ("GET", "/runs"): "viewer",
    ("POST", "/runs"): "operator",
    ("GET", "/runs/{run}"): "viewer",
    ("PATCH", "/runs/{run}"): "engineer",
    ("POST", "/runs/{run}/approve"): "engineer",
    ("POST", "/runs/{run}/pause"): "operator",
    ("POST", "/runs/{run}/resume"): "operator",
    ("POST", "/runs/{run}/answer"): "operator",
    ("POST", "/runs/{run}/abort"): "operator",
    ("GET", "/runs/{run}/files/{name}"): "viewer",
    ("GET", "/comparisons"): "viewer",
    ("GET", "/comparisons/best"): "viewer",
    ("GET", "/comparisons/traces"): "viewer",
    ("GET", "/trends"): "viewer",
    ("GET", "/models"): "viewer",
    ("GET", "/models/{model}/text"): "viewer",
    ("PUT", "/models/{model}"): "engineer",
    ("DELETE", "/models/{model}"): "engineer",
    ("GET", "/controllers"): "viewer",
    ("GET", "/controllers/{controller}/text"): "viewer",
    ("PUT", "/controllers/{controller}"): "engineer",
    ("DELETE", "/controllers/{controller}"): "engineer",
    ("POST", "/plans/{plan}/copies"): "engineer",
    ("POST", "/drafts"): "engineer",
    ("POST", "/drafts/clouds"): "engineer",
    ("POST", "/drafts/segments"): "engineer",
    ("POST", "/identifications"): "engineer",
    ("GET", "/identifications/{study}"): "viewer",
    ("POST", "/diagnoses"): "engineer",
    ("GET", "/diagnoses/{study}"): "viewer",
    ("POST", "/tunings"): "engineer",
    ("GET", "/tunings/{study}"): "viewer",
    ("POST", "/autotunings/envelopes"): "engineer",
    ("POST", "/autotunings"): "engineer",
    ("GET", "/autotunings/{study}"): "viewer",
    ("GET", "/studies"): "viewer",
    ("GET", "/studies/{study}"): "viewer",
    ("POST", "/studies/{study}/cancel"): "engineer",
    ("DELETE", "/studies/{study}"): "engineer",
    ("GET", "/studies/{study}/files/{name}"): "viewer",
    ("POST", "/designs"): "engineer",
    ("GET", "/campaign-examples"): "viewer",
    ("GET", "/campaigns"): "viewer",
    ("POST", "/campaigns"): "engineer",
    ("GET", "/campaigns/{campaign}"): "viewer",
    ("GET", "/campaigns/{campaign}/findings"): "viewer",
    ("GET", "/campaigns/{campaign}/simulations/{simulation}"): "engineer",
    ("POST", "/campaigns/{campaign}/cancel"): "engineer",
    ("DELETE", "/campaigns/{campaign}"): "engineer",
    ("POST", "/campaigns/{campaign}/resume"): "engineer",
    ("GET", "/campaigns/{campaign}/files/{name}"): "viewer",
    ("GET", "/bench-files"): "viewer",
    ("GET", "/bench-files/{bench}/text"): "viewer",
    ("PUT", "/bench-files/{bench}"): "engineer",
    ("DELETE", "/bench-files/{bench}"): "engineer",
    ("PUT", "/bench-files/{bench}/service"): "engineer",
    ("DELETE", "/bench-files/{bench}/service"): "engineer",
    ("POST", "/file-checks"): "engineer",
    ("GET", "/versions/{kind}/{name}"): "viewer",
    ("GET", "/versions/{kind}/{name}/{number}/text"): "viewer",
    ("GET", "/recordings"): "viewer",
    ("GET", "/recordings/{recording}/curves"): "viewer",
    ("GET", "/recordings/{recording}/simulation"): "engineer",
    ("POST", "/recordings"): "engineer",
    ("GET", "/recordings/{recording}"): "viewer",
    ("DELETE", "/recordings/{recording}"): "engineer",
    ("PUT", "/recordings/{recording}/content"): "engineer",
    ("POST", "/recordings/{recording}/ending"): "engineer",
    ("POST", "/recordings/{recording}/check"): "engineer",
    ("GET", "/recordings/{recording}/files/{name}"): "viewer",
    ("GET", "/me"): "viewer",
    ("POST", "/session"): "",
    ("DELETE", "/session"): "",
    ("GET", "/sign-in"): "",
    ("GET", "/sign-in/return"): "",
    ("GET", "/people"): "admin",
    ("DELETE", "/people/{person}/sessions"): "admin",
    ("GET", "/tokens"): "admin",
    ("POST", "/tokens"): "admin",
    ("DELETE", "/tokens/{token}"): "admin",
    ("GET", "/audit"): "admin",
}
#: Names of things that there are not: who may ask hears 404 or 422, nothing is changed.
_NONE = {"bench": "none", "plan": "none", "run": "2000000000", "token": "2000000000", "name": "x"}
_NONE |= {"agent": "0" * 32, "order": "0" * 16, "model": "none", "controller": "none"}
_NONE |= {"recording": "2000000000", "number": "1", "picture": "none.png"}
_NONE |= {
    "study": "2000000000",
    "campaign": "2000000000",
    "note": "2000000000",
    "person": "2000000000",
    "reservation": "2000000000",
    "tag": "x",
    "simulation": "1",
    "kind": "plan",
}


@pytest.fixture(scope="module")
def tokens(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Served, dict[str, str]]]:
    folder = tmp_path_factory.mktemp("access")
    admin = _token(folder / "data", "root=admin")
    with served(folder / "data", "--rate", "1000", state=folder / "state", token=admin) as service:
        secrets = {str(role): _made(service, f"the {role}", role) for role in ROLES}
        yield service, secrets


def test_the_table_has_every_endpoint() -> None:
    paths = json.loads(openapi_text())["paths"]
    found = {(method.upper(), path.removeprefix("/api/v1")) for path, by in paths.items() for method in by}
    assert found == set(LEAST)


def test_the_document_in_the_repository_is_that_of_the_code() -> None:
    path = ROOT / "docs/reference/openapi.json"
    assert path.read_text("utf-8") == openapi_text(), "make openapi writes it anew"


@pytest.mark.parametrize(("method", "path"), LEAST, ids=[" ".join(key) for key in LEAST])
def test_each_role_may_what_the_table_says(
    tokens: tuple[Served, dict[str, str]], method: str, path: str
) -> None:
    service, secrets = tokens
    least = LEAST[method, path]
    for role in ("", *ROLES):
        status = _status(service, method, path.format(**_NONE), secrets.get(role, ""))
        if least == "" or _may(role, least):
            assert status not in (401, 403), role or "no one"
        else:
            assert status == (403 if role else 401), role or "no one"


def test_a_hazardous_plan_waits_for_a_second_person(tokens: tuple[Served, dict[str, str]]) -> None:
    service, secrets = tokens
    plan = SHORT.replace("name: short", "name: risky\nhazardous: the axle may jump")
    service.ask("PUT", "/api/v1/plans/risky", plan, token=secrets["engineer"])
    body = {"plan": "risky", "bench": "sim"}
    run = service.ask("POST", "/api/v1/runs", body, token=secrets["engineer"])
    assert (run["state"], run["hazard"]) == ("waiting_approval", "the axle may jump")
    approve = f"/api/v1/runs/{run['id']}/approve"
    with pytest.raises(RefusedError, match="a second person"):
        service.ask("POST", approve, token=secrets["engineer"])
    service.post(f"/runs/{run['id']}/abort")
    with pytest.raises(RefusedError, match="does not wait"):
        service.ask("POST", approve, token=secrets["admin"])
    done = [(one["who"], one["action"]) for one in service.get("/audit")]
    assert ("the engineer", "queue") in done
    assert ("root", "abort") in done


def test_a_revoked_token_is_worth_nothing_and_the_last_administrator_stays(
    tokens: tuple[Served, dict[str, str]],
) -> None:
    service, _ = tokens
    made = service.post("/tokens", {"name": "for a while", "role": "viewer"})
    assert service.ask("GET", "/api/v1/me", token=made["secret"])["role"] == "viewer"
    service.ask("DELETE", f"/api/v1/tokens/{made['token']['id']}")
    with pytest.raises(RefusedError, match="401"):
        service.ask("GET", "/api/v1/me", token=made["secret"])


def test_other_sites_other_names_and_too_much_are_refused(service: Served) -> None:
    here = urlsplit(service.url).netloc
    stop = "/api/v1/benches/none/emergency-stop"
    assert _raw(service, "POST", stop, {"Host": here, "Origin": "http://evil.example"}) == 403
    assert _raw(service, "GET", "/api/v1/health", {"Host": "evil.example"}) == 421
    assert _raw(service, "POST", stop, {"Host": here, "Origin": service.url}) == 404
    assert _raw(service, "POST", "/api/v1/runs", {"Host": here, "Content-Length": "999999999"}) == 413


def test_an_emergency_stop_is_answered_when_nothing_else_is(tmp_path: Path) -> None:
    with served(tmp_path / "data", "--rate", "1", state=tmp_path / "state") as service:
        here = {"Host": urlsplit(service.url).netloc}
        statuses = [_raw(service, "GET", "/api/v1/health", here) for _ in range(20)]
        assert (statuses[0], statuses[-1]) == (200, 429)
        assert _raw(service, "POST", "/api/v1/benches/none/emergency-stop", here) == 404


def _may(role: str, least: str) -> bool:
    """An agent does an agent's work and nothing else; an administrator does everything."""
    if "agent" in (role, least):
        return role == least or role == "admin"
    people = list(map(str, LADDER))
    return role != "" and people.index(role) >= people.index(least)


def _status(service: Served, method: str, path: str, token: str) -> int:
    where = urlsplit(service.url)
    connection = http.client.HTTPConnection(where.hostname or "", where.port, timeout=30)
    headers = {"Authorization": f"Bearer {token}"} if token else {}
    body = None
    if method in ("POST", "PUT", "PATCH"):
        headers["Content-Type"], body = "application/json", "{}"
    try:
        connection.request(method, f"/api/v1{path}", body, headers)
        return connection.getresponse().status
    finally:
        connection.close()


def _raw(service: Served, method: str, path: str, headers: dict[str, str]) -> int:
    where = urlsplit(service.url)
    connection = http.client.HTTPConnection(where.hostname or "", where.port, timeout=30)
    try:
        connection.putrequest(method, path, skip_host=True)
        for name, value in headers.items():
            connection.putheader(name, value)
        connection.endheaders()
        return connection.getresponse().status
    finally:
        connection.close()


def _made(service: Served, name: str, role: str) -> str:
    made: Any = service.post("/tokens", {"name": name, "role": role})
    return str(made["secret"])


def _token(data: Path, wanted: str) -> str:
    command = [*HIL, "serve", "--data", str(data), "--add-token", wanted]
    done = subprocess.run(command, capture_output=True, text=True, check=True, env=environment_of(data))
    return done.stdout.splitlines()[-1]
