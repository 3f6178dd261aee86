"""The inputs of a recorded run as files again: plan, bench, model, controllers, descriptions of devices."""

from __future__ import annotations

import re
import shlex
from pathlib import Path, PurePosixPath
from typing import Any

import yaml

from hil.core.errors import BadInputError
from hil.core.files.toml_file import parse_toml
from hil.core.recording import Recording
from hil.core.result import RunResult

PLAN, BENCH, MODEL = "plan.yaml", "bench.toml", "model.toml"


def inputs_of(recording: Recording) -> dict[str, bytes]:
    """Files of one folder in which the run can be executed again, by name.

    Plan and bench name each other file by its path at that time; here all lie beside them, so the paths go.

    Raises:
        BadInputError: the recording has no plan or no bench: another tool made it, or they are lost.
    """
    stored = recording.attachments
    for name in (PLAN, BENCH):
        if name not in stored:
            raise BadInputError(
                f"has no {name}: its run cannot be repeated",
                where=str(recording.source),
                fix="use a recording of hil run",
            )
    plan, bench = stored[PLAN].decode(), stored[BENCH].decode()
    files = {
        PurePosixPath(name).name: content
        for name, content in stored.items()
        if name.startswith(("controller/", "device/"))
    }
    tables = parse_toml(bench, BENCH)
    if MODEL not in stored and "simulation" in tables:
        raise BadInputError(
            "holds no model, as it is a replay: its run cannot be repeated",
            where=str(recording.source),
            fix="use the recording that was replayed",
        )
    if MODEL in stored:
        files[_model_name(tables)] = stored[MODEL]
    paths = _paths([yaml.safe_load(plan), tables], set(files))
    return {**files, PLAN: _beside(plan, paths).encode(), BENCH: _beside(bench, paths).encode()}


def command_again(recording: Recording, folder: Path) -> str:
    """The command that carries the run out again, with the values that its variables had."""
    words = ["hil", "run", str(folder / PLAN), "--bench", str(folder / BENCH)]
    attached = recording.attachments.get("run.json")
    values = RunResult.model_validate_json(attached).variables if attached else ()
    for one in values:
        words += ["--set", f"{one.name}={one.value!r}"]
    return shlex.join(words)


def _model_name(tables: dict[str, Any]) -> str:
    model = tables.get("simulation", {}).get("model", MODEL)
    return PurePosixPath(str(model)).name if str(model).endswith(".toml") else f"{model}.toml"


def _paths(content: Any, files: set[str]) -> list[str]:
    """Values that name one of the files in another folder."""
    if isinstance(content, dict):
        content = list(content.values())
    if isinstance(content, list):
        return [path for value in content for path in _paths(value, files)]
    named = isinstance(content, str) and "/" in content and PurePosixPath(content).name in files
    return [content] if named else []


def _beside(text: str, paths: list[str]) -> str:
    for path in sorted(set(paths), key=len, reverse=True):
        text = re.sub(rf"(?<![\w./-]){re.escape(path)}(?![\w/-])", PurePosixPath(path).name, text)
    return text
