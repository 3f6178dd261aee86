"""How hot functions are compiled: cached, IEEE division, contraction allowed.

A compiled function carries the constants and the inlined functions of every module that it imports, but numba
only looks at its own file to see whether a cached one is still good. Here it is good while that file and all
project files that it imports, directly or not, are what they were, under the names that they had.
"""

from __future__ import annotations

import ast
import hashlib
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

from numba import njit
from numba.core.caching import FunctionCache

_F = TypeVar("_F", bound=Callable[..., object])
# No 'nnan' or 'ninf': limits that are off are infinite, and a diverged simulation must show as NaN.
_FAST = {"contract", "arcp", "reassoc", "nsz"}


def compiled(function: _F) -> Any:
    """Compile `function` with numba."""
    return _cached(function)


def inlined(function: _F) -> Any:
    """Compile `function` into each of its callers."""
    return _cached(function, inline="always")


def compiled_parallel(function: _F) -> Any:
    """Compile `function` with its prange loops spread over threads."""
    return _cached(function, parallel=True)


def _cached(function: _F, **options: Any) -> Any:
    dispatcher = njit(error_model="numpy", fastmath=_FAST, **options)(function)
    dispatcher._cache = _Cache(function)
    return dispatcher


class _Cache(FunctionCache):  # type: ignore[misc]
    """numba's cache, good for what the function's sources are now."""

    def __init__(self, function: Callable[..., object]) -> None:
        super().__init__(function)
        self._cache_file._source_stamp = source_stamp(
            function.__module__, Path(function.__code__.co_filename)
        )


def source_stamp(module: str, file: Path) -> str:
    """Digest of a module's name and source, and of those of every module of its project that it imports."""
    digest = hashlib.sha256()
    seen = {module: file}
    waiting = [module]
    while waiting:
        name = waiting.pop()
        for imported, path in _imports(name, seen[name]):
            if imported not in seen:
                seen[imported] = path
                waiting.append(imported)
    for name in sorted(seen):
        digest.update(f"{name}\0{_content(seen[name])}\0".encode())
    return digest.hexdigest()


@cache
def _content(file: Path) -> str:
    return file.read_text("utf-8") if file.is_file() else ""


@cache
def _imports(module: str, file: Path) -> tuple[tuple[str, Path], ...]:
    """Modules of the same project that a file imports, with their files."""
    project = file.parents[module.count(".")]
    found = []
    for choices in _named(_content(file)):
        files = ((name, _file_of(name, project)) for name in choices)
        found += [(name, path) for name, path in files if path is not None][:1]
    return tuple(found)


def _file_of(name: str, project: Path) -> Path | None:
    path = project.joinpath(*name.split("."))
    for file in (path.with_suffix(".py"), path / "__init__.py"):
        if file.is_file():
            return file
    return None


def _named(source: str) -> Iterator[tuple[str, ...]]:
    """What each import may mean: a module in a package, or else something that the package itself holds."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from ((one.name,) for one in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            yield from ((f"{node.module}.{one.name}", node.module) for one in node.names)
