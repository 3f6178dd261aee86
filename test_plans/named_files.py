"""Built-in files by their names, beside files by their paths."""

from __future__ import annotations

from pathlib import Path

from hil.core.errors import BadInputError
from hil.core.errors.wording import did_you_mean
from hil.core.files import is_file
from test_plans.building import brief


def names_in(folder: Path) -> tuple[str, ...]:
    """Names of the built-in YAML files in `folder`, in order."""
    return tuple(sorted(path.stem for path in folder.glob("*.yaml")))


def named_file(name_or_path: str | Path, folder: Path, kind: str, built_in: str = "one") -> Path:
    """A path as it is, or the built-in file of `folder` that has this name.

    Args:
        kind: what it is, for messages; `built_in`: the same of one that comes with the package.

    Raises:
        BadInputError: it is no path, and there is no such name.
    """
    path = Path(name_or_path)
    if path.suffix in (".yaml", ".yml") or len(path.parts) > 1 or is_file(path):
        return path
    names = names_in(folder)
    if path.name in names:
        return folder / f"{path.name}.yaml"
    raise BadInputError(
        f"there is no {kind} {brief(path.name)}, neither a file nor a built-in {built_in}",
        fix=f"{did_you_mean(path.name, names)}; a file's name ends in .yaml",
    )
