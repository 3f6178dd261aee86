"""Pictures of prompts: what is taken for one, and where it lies."""

from __future__ import annotations

from pathlib import Path

import pytest
from sqlalchemy import Engine

from hil.core.errors import BadInputError
from hil.service.files.pictures import Pictures, refuse_no_picture
from hil.service.files.uploads import NameTakenError
from hil.service.store import GivenStore
from hil.service.worker_pool.plan_reading import read_given
from tests.hil.service.served import ASKING

SVG = b'<?xml version="1.0"?>\n<!-- a cage -->\n<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 4 3"/>'
PNG = b"\x89PNG\r\n\x1a\n and so on"


@pytest.mark.parametrize(
    ("name", "content"), [("a.png", PNG), ("a.jpg", b"\xff\xd8\xff\xe0"), ("a.svg", SVG)]
)
def test_a_picture_is_what_its_name_says(name: str, content: bytes) -> None:
    refuse_no_picture(name, content)


@pytest.mark.parametrize(
    ("name", "content", "why"),
    [
        ("a.png", SVG, "is no PNG"),
        ("a.jpeg", PNG, "is no JPEG"),
        ("a.svg", b"<html><svg></svg></html>", "is no SVG"),
        ("a.svg", b"", "is no SVG"),
        ("a.gif", b"GIF89a", "is no name of a picture"),
        ("../a.png", PNG, "is no name of a picture"),
        ("a.png", PNG + bytes(250_000), "has more than 250 kB"),
    ],
)
def test_anything_else_is_refused(name: str, content: bytes, why: str) -> None:
    with pytest.raises(BadInputError, match=why):
        refuse_no_picture(name, content)


def test_all_that_there_are_lie_beside_the_plans_and_nothing_else_does(
    engine: Engine, tmp_path: Path
) -> None:
    one, other = (Pictures(GivenStore(engine), tmp_path / name) for name in ("one", "other"))
    (tmp_path / "other").mkdir()
    (tmp_path / "other/by-hand.png").write_bytes(PNG)
    (tmp_path / "other/plan.yaml").write_text("name: plan")
    one.give("cage.svg", SVG, "anna")
    one.give("cage.svg", SVG, "bert")
    with pytest.raises(NameTakenError, match="another picture"):
        one.give("cage.svg", SVG + b" ", "bert")
    other.bring()
    assert {path.name for path in (tmp_path / "other").iterdir()} == {"cage.svg", "plan.yaml"}
    assert (tmp_path / "other/cage.svg").read_bytes() == other.content("cage.svg") == SVG
    assert other.names() == ["cage.svg"]
    assert one.remove("cage.svg")
    assert not one.remove("cage.svg")
    other.bring()
    assert other.content("cage.svg") is None
    assert not (tmp_path / "other/cage.svg").exists()


def test_a_given_plan_shows_no_picture_that_the_service_lacks(tmp_path: Path) -> None:
    plan = ASKING.replace("Is the cage shut?'", "Is the cage shut?', picture: cage.svg")
    with pytest.raises(BadInputError, match=r"cage\.svg.*does not have"):
        read_given("asking", plan, tmp_path)
    (tmp_path / "cage.svg").write_bytes(SVG)
    assert "cage.svg" in read_given("asking", plan, tmp_path).files
