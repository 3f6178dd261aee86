"""Private modules stay in their packages, and modules have tests of their own."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = ("hil", "drivers", "test_plans", "reports", "sim_backend")


def imported_by(file: Path) -> Iterator[str]:
    """Names of modules, and of what is taken from them."""
    for node in ast.walk(ast.parse(file.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            yield from (one.name for one in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            assert node.level == 0, f"{file}: relative import"
            yield node.module
            yield from (f"{node.module}.{one.name}" for one in node.names)


def holder_of(name: str, root: Path = ROOT) -> str:
    """The package of the first private module in a name; empty if there is none."""
    parts = name.split(".")
    for number, part in enumerate(parts):
        place = root.joinpath(*parts[: number + 1])
        if part.startswith("_") and (place.with_suffix(".py").is_file() or place.is_dir()):
            return ".".join(parts[:number])
    return ""


def crossings(top: str, root: Path = ROOT) -> set[tuple[str, str]]:
    """(importing package, package whose private module it imports), where they are not the same."""
    found = set()
    for file in (root / top).rglob("*.py"):
        package = ".".join(file.parent.relative_to(root).parts)
        holders = {holder_of(name, root) for name in imported_by(file) if name.split(".")[0] in PACKAGES}
        found |= {(package, holder) for holder in holders - {"", package}}
    return found


def test_private_modules_are_not_imported_across_packages() -> None:
    found = set().union(*(crossings(top) for top in PACKAGES))
    assert found == set(), "import from the package, or make the module public"


def test_a_crossing_is_seen(tmp_path: Path) -> None:
    for folder in ("hil/a", "hil/b/c"):
        (tmp_path / folder).mkdir(parents=True)
    (tmp_path / "hil/b/_own.py").write_text("")
    (tmp_path / "hil/b/c/one.py").write_text("from hil.b import _own\n")
    (tmp_path / "hil/b/two.py").write_text("from hil.b._own import x\n")
    (tmp_path / "hil/a/three.py").write_text("import hil.b._own\nfrom hil.b import _a_function\n")
    assert crossings("hil", tmp_path) == {("hil.b.c", "hil.b"), ("hil.a", "hil.b")}


@pytest.mark.parametrize("package", ["hil/analysis/diagnosis", "hil/engine"])
def test_every_module_is_imported_by_a_test_of_its_own(package: str) -> None:
    tests = (ROOT / "tests" / package).rglob("test_*.py")
    imported = {name for file in tests for name in imported_by(file)}
    modules = (file for file in (ROOT / package).rglob("*.py") if file.name != "__init__.py")
    names = {".".join(file.relative_to(ROOT).with_suffix("").parts) for file in modules}
    assert names - imported == set(), f"no test below tests/{package} imports these"
