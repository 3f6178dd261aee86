"""Reads what people give before the service takes it: whatever it is, it holds no one up here."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from hil.core.controller import controller_from_toml
from hil.core.files.toml_file import parse_toml
from hil.core.model import model_from_dict
from hil.service.worker_pool.plan_reading import read_given


def plan(name: str, text: str, folder: str) -> dict[str, Any]:
    """Fields of `GivenPlan`.

    Raises:
        BadInputError: all that is wrong with it.
    """
    found = read_given(name, text, Path(folder))
    return {"data": found.data.model_dump(mode="json"), "files": found.files}


def model(name: str, text: str) -> dict[str, Any]:
    """Nothing, once it has been read.

    Raises:
        BadInputError: it is no model.
    """
    where = f"{name}.toml"
    model_from_dict(parse_toml(text, where), where, text)
    return {}


def controller(name: str, text: str) -> dict[str, Any]:
    """Nothing, once it has been read.

    Raises:
        BadInputError: it is no controller.
    """
    controller_from_toml(text, f"{name}.toml")
    return {}
