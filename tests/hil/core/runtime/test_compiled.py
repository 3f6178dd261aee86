"""A compiled function is never older than its sources."""

import ast
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from hil.core.runtime.compiled import _named, compiled, uncounted

ROOT = Path(__file__).parents[4]
TABLE = "FIRST, SECOND = {order}\n"
LAW = """
from hil.core.runtime.compiled import inlined
from {package} import _table as T

@inlined
def law(p):
    return p[T.FIRST]
"""
KERNEL = """
from hil.core.runtime.compiled import compiled
from {package}._law import law

@compiled
def kernel(p):
    return 10.0 * law(p)
"""
ASK = """
import sys, numpy
sys.path.insert(0, ".")
from {package}._kernel import kernel
print(kernel(numpy.array([1.0, 2.0])), sum(kernel.stats.cache_hits.values()))
"""


def write(package: Path, order: str) -> None:
    package.mkdir(exist_ok=True)
    (package / "__init__.py").write_text("")
    (package / "_table.py").write_text(TABLE.format(order=order))
    (package / "_law.py").write_text(LAW.format(package=package.name))
    (package / "_kernel.py").write_text(KERNEL.format(package=package.name))


def asked(package: Path) -> list[str]:
    """What a new process gets from the kernel, and how often it took it from the cache."""
    code = ASK.format(package=package.name)
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=package.parent, capture_output=True, text=True, check=True
    )
    return done.stdout.split()


@pytest.mark.slow
def test_a_changed_table_or_a_moved_package_never_runs_an_old_kernel(tmp_path):
    package = tmp_path / "plant"
    write(package, "0, 1")
    assert asked(package) == ["10.0", "0"]
    assert asked(package) == ["10.0", "1"]
    write(package, "1, 0")
    assert asked(package) == ["20.0", "0"]
    moved = package.rename(
        tmp_path / "moved_away"
    )  # its cache goes with it; as long a name would keep its bytecode
    write(moved, "1, 0")
    assert asked(moved) == ["20.0", "0"]
    assert asked(moved) == ["20.0", "1"]


def test_the_stamp_follows_imports_but_not_what_is_not_imported(tmp_path):
    from hil.core.runtime.compiled import source_stamp

    def stamp(order: str, other: str) -> str:
        folder = tmp_path / f"{order}{other}"
        folder.mkdir()
        write(folder / "plant", order)
        (folder / "plant" / "_other.py").write_text(other)
        return source_stamp("plant._kernel", folder / "plant" / "_kernel.py")

    first = stamp("0, 1", "A = 1")
    assert stamp("0, 1", "A = 2") == first
    assert stamp("1, 0", "A = 1") != first


def test_the_stamp_follows_what_a_package_imports_and_finds_beside_it(tmp_path):
    from hil.core.runtime.compiled import source_stamp

    def stamp(law: str) -> str:
        folder = tmp_path / law
        effects = folder / "plant" / "effects"
        effects.mkdir(parents=True)
        (folder / "plant" / "_kernel.py").write_text("from plant.effects import LAWS\n")
        (effects / "__init__.py").write_text("from plant.effects._registry import LAWS\n")
        (effects / "_registry.py").write_text("import pkgutil\nLAWS = list(pkgutil.iter_modules([]))\n")
        (effects / "backlash.py").write_text(f"LAW = {law!r}\n")
        return source_stamp("plant._kernel", folder / "plant" / "_kernel.py")

    assert stamp("series") != stamp("tension")


def test_imports_are_found_as_the_parser_finds_them():
    def parsed(source):
        for node in ast.walk(ast.parse(source)):
            if isinstance(node, ast.Import):
                yield from ((one.name,) for one in node.names)
            elif isinstance(node, ast.ImportFrom) and not node.level:
                yield from ((f"{node.module}.{one.name}", node.module) for one in node.names)

    files = [
        f for package in ("hil/core", "hil/plant", "sim_backend") for f in (ROOT / package).rglob("*.py")
    ]
    assert len(files) > 50
    for file in files:
        source = file.read_text("utf-8")
        assert set(_named(source)) == set(parsed(source)), file
    assert list(_named("from a.b import (  # why\n    c as d,\n    e,\n)\nimport f, g\n")) == [
        ("a.b.c", "a.b"), ("a.b.e", "a.b"), ("f",), ("g",)
    ]  # fmt: skip


@compiled
def _rows_summed(array):  # type: ignore[no-untyped-def]
    array, total = uncounted(array), 0.0
    for i in range(array.shape[0]):
        row = array[i]
        row[0] += 1.0
        total += row.sum()
    return total


def test_an_uncounted_array_is_the_same_memory_and_its_owner_loses_nothing():
    array = np.arange(12.0).reshape(4, 3)
    before = sys.getrefcount(array)
    assert _rows_summed(array) == 70.0
    assert array[:, 0].tolist() == [1.0, 4.0, 7.0, 10.0]
    assert sys.getrefcount(array) == before
