"""Pictures of prompts over the API: given, shown with a question, sent with a plan."""

from __future__ import annotations

import urllib.request
from pathlib import Path

import pytest

from hil.client import Client
from hil.client.sent_plan import give_plan
from hil.core.errors import BadInputError
from test_plans import load_plan
from tests.hil.service.served import ASKING, RefusedError, Served

SVG = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 4 3"/>'
NAME = "/api/v1/pictures/door-a.svg"


def _showing(plan: str, picture: str) -> str:
    text = ASKING.replace("name: asking", f"name: {plan}")
    return text.replace("{text: 'Is the cage shut?'}", f"{{text: 'Is it shut?', picture: {picture}}}")


def test_a_picture_runs_and_loads_nothing_where_it_is_opened(service: Served) -> None:
    service.ask("PUT", NAME, SVG)
    assert "door-a.svg" in service.get("/pictures")
    with urllib.request.urlopen(service.url + NAME, timeout=30) as answer:
        assert answer.read().decode() == SVG
        assert answer.headers["content-type"] == "image/svg+xml"
        assert answer.headers["content-security-policy"].startswith("default-src 'none'")
        assert answer.headers["x-content-type-options"] == "nosniff"
    service.ask("DELETE", NAME)
    with pytest.raises(RefusedError, match="404"):
        service.get("/pictures/door-a.svg")


@pytest.mark.parametrize(
    ("name", "content", "status"),
    [("a.svg", "<html/>", 422), ("a.png", SVG, 422), ("a.gif", "GIF89a", 422), ("..%2Fa.svg", SVG, 404)],
)
def test_what_is_no_picture_is_refused(service: Served, name: str, content: str, status: int) -> None:
    with pytest.raises(RefusedError) as refused:
        service.ask("PUT", f"/api/v1/pictures/{name}", content)
    assert refused.value.status == status


def test_a_question_names_its_picture_and_by_when_it_is_to_be_answered(service: Served) -> None:
    with pytest.raises(RefusedError, match="does not have"):
        service.give("door", _showing("door", "door-b.svg"))
    service.ask("PUT", "/api/v1/pictures/door-b.svg", SVG)
    service.give("door", _showing("door", "door-b.svg"))
    with pytest.raises(RefusedError, match="is shown by the plan 'door'"):
        service.ask("DELETE", "/api/v1/pictures/door-b.svg")
    run = service.queue("door")
    asked = service.until(run, lambda found: found["prompt"])["prompt"]
    assert (asked["text"], asked["picture"]) == ("Is it shut?", "door-b.svg")
    assert asked["answer_by"] > service.get(f"/runs/{run}")["started_at"]
    service.post(f"/runs/{run}/answer", {"text": "yes"})
    over = service.over(run)
    assert (over["prompt"], over["verdict"]) == (None, "pass")
    for path in ("plans/door", "pictures/door-b.svg"):
        service.ask("DELETE", f"/api/v1/{path}")


def test_a_plan_takes_its_picture_along(service: Served, tmp_path: Path) -> None:
    (tmp_path / "gate.yaml").write_text(_showing("gate", "gate.svg"), "utf-8")
    client = Client(service.url, token="")
    with pytest.raises(BadInputError, match=r"gate\.svg"):
        give_plan(client, load_plan(tmp_path / "gate.yaml"))
    (tmp_path / "gate.svg").write_text(SVG, "utf-8")
    assert give_plan(client, load_plan(tmp_path / "gate.yaml")) == "gate"
    assert "gate.svg" in service.get("/pictures")
    for path in ("plans/gate", "pictures/gate.svg"):
        service.ask("DELETE", f"/api/v1/{path}")
