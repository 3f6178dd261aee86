"""Shipped files that are given by their names in place of a path: models, and targets of `hil explain`."""

from __future__ import annotations

import importlib.resources
from collections.abc import Mapping
from pathlib import Path
from typing import Literal

from hil.core.errors import BadInputError
from hil.core.errors.wording import did_you_mean, printable

Shipped = Literal["model", "targets file"]

#: What the text of such a file holds; bench files, which hold `[buses.`, are neither.
_HOLDS: Mapping[Shipped, str] = {"model": "\nkind = ", "targets file": "\n[targets]"}


def shipped_file(name_or_path: str | Path, what: Shipped, beside: Path | None = None) -> Path:
    """The file that is given by its path, or by the name of a shipped one.

    A name is a word without a folder and without the ending .toml; a file that is called so comes first.
    Paths are relative to the folder `beside`, or to the current one.

    Raises:
        BadInputError: there is neither a file nor a shipped one of that name.
    """
    path = (beside or Path()) / name_or_path
    if path.suffix == ".toml" or path.name != str(name_or_path) or _is_there(path):
        return path
    known = shipped_names(what)
    if path.name in known:
        return _benches() / f"{path.name}.toml"
    raise BadInputError(
        f"there is no {what} '{printable(name_or_path, 60)}'",
        fix=f"{did_you_mean(path.name, known)}; or give a file, whose name ends in .toml",
    )


def shipped_names(what: Shipped) -> tuple[str, ...]:
    """Names of the shipped files of a kind."""
    texts = {path.stem: path.read_text("utf-8") for path in _benches().glob("*.toml")}
    return tuple(
        sorted(name for name, text in texts.items() if _HOLDS[what] in text and "[buses." not in text)
    )


def _benches() -> Path:
    return Path(str(importlib.resources.files("benches")))


def _is_there(path: Path) -> bool:
    try:
        return path.exists()
    except (OSError, ValueError):  # no file can have such a name
        return False
