"""What the page offers as the beginning of a new file is a file without a mistake, with comments."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

import hil.service
from hil.core.controller import load_controller
from hil.core.model import load_model

_KINDS = Path(hil.service.__file__).with_name("frontend") / "src/views/given/kinds.ts"
_TEMPLATES = dict(
    re.findall(r"const (MODEL|CONTROLLER|BENCH) = `(.*?)`;", _KINDS.read_text("utf-8"), re.DOTALL)
)


@pytest.mark.parametrize(("name", "load"), [("MODEL", load_model), ("CONTROLLER", load_controller)])
def test_a_new_file_begins_without_a_mistake(tmp_path: Path, name: str, load: object) -> None:
    assert callable(load)
    file = tmp_path / "new.toml"
    file.write_text(_TEMPLATES[name], "utf-8")
    load(file)
    assert _TEMPLATES[name].count("#") > 3


def test_a_new_bench_file_says_its_name() -> None:
    assert tomllib.loads(_TEMPLATES["BENCH"])["name"] == "my_bench"
