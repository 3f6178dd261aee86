"""TOML that people give: what is hostile is refused before it is read."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil.core.errors import BadInputError
from hil.core.files.toml_file import MOST_PARTS, parse_toml
from test_plans import plan_from_text

BOMB = ".".join(["a"] * 40_000)  # of which tomllib needs the square


@pytest.mark.parametrize(
    "text",
    [
        f"{BOMB} = 1",
        f"[{BOMB}]",
        f"[[{BOMB}]]",
        f"x = {{{BOMB} = 1}}",
        "x = 1\n" + " . ".join(['"a b"'] * 40_000) + " = 1",
        "x = '''\n# no comment\n'''\n" + f"{BOMB} = 1",
        ".".join(["a"] * (MOST_PARTS + 1)) + " = 1",
    ],
    ids=["key", "table", "tables", "inline", "quoted", "behind a text", "just too many"],
)
def test_a_key_of_too_many_parts_is_refused_with_its_line(text: str) -> None:
    with pytest.raises(BadInputError, match="more than 32 parts") as found:
        parse_toml(text, "m.toml")
    assert found.value.where.startswith("m.toml: line")


@pytest.mark.parametrize(
    "text",
    [
        ".".join(["a"] * MOST_PARTS) + " = 1",
        f'x = "{BOMB}"',
        f"x = '{BOMB}'",
        f"x = 1 # {BOMB}",
        f'x = """\n{BOMB}\n"""',
        f"x = '''{BOMB}'''",
        "\n".join(f"a{i} = {i}.5" for i in range(1000)),
    ],
    ids=["so many", "text", "literal", "comment", "long text", "long literal", "numbers"],
)
def test_what_only_looks_like_one_is_read(text: str) -> None:
    assert parse_toml(text, "m.toml")


def test_a_plan_that_is_such_a_file_is_refused_as_no_plan() -> None:
    with pytest.raises(BadInputError):
        plan_from_text(f"{BOMB} = 1", "p.yaml", Path())


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a = 1\nb c\n", "FILE, line 2: not a TOML file: Expected '=' after a key in a key/value pair"),
        ("a = 1\nb = [1,\n\n", "FILE, line 2: not a TOML file: Invalid value, at the end of the file"),
    ],
)
def test_what_is_no_toml_is_named_with_its_line_once(text: str, words: str) -> None:
    with pytest.raises(BadInputError) as refused:
        parse_toml(text, "FILE")
    assert str(refused.value) == f"{words}\n  correct the file there"
