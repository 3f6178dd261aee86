"""How hot functions are compiled: cached, IEEE division, rounded as Python rounds.

Nothing is contracted or summed in another order: where contact comes and goes a last bit decides what comes
next, and a diagnosis must not hang on which build of a kernel it ran.

A compiled function carries the constants and the inlined functions of every module that it imports, but numba
only looks at its own file to see whether a cached one is still good. Here it is good while that file and all
project files that it imports, directly or not, are what they were, under the names that they had.
"""

from __future__ import annotations

import hashlib
import logging
import re
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

from numba import njit
from numba.core.caching import FunctionCache, IndexDataCacheFile
from numba.core.runtime.nrt import rtsys
from numba.extending import intrinsic

logger = logging.getLogger(__name__)
#: What compiled functions depend on beside the sources here: a digest of other packages' laws, '' for none.
_outside = ""

_F = TypeVar("_F", bound=Callable[..., object])
_IMPORT = re.compile(
    r"^[ \t]*(?:from[ \t]+([\w.]+)[ \t]+import[ \t]+(?:\(([^)]*)\)|([^\n(]*))|import[ \t]+([^\n]*))",
    re.MULTILINE,
)
_FINDS_SIBLINGS = "pkgutil.iter_modules("  # a registry imports every module beside it
_COMMENT = re.compile(r"#[^\n]*")


def compiled(function: _F) -> Any:
    """Compile `function` with numba."""
    return _cached(function)


def inlined(function: _F) -> Any:
    """Compile `function` into each of its callers."""
    return _cached(function, forceinline=True)


def chosen_by_type(function: _F) -> Any:
    """A function with compiled forms of its own, by numba's `overload`, for the types that it is given."""
    return function


def compiled_without_lock(function: _F) -> Any:
    """Compile `function` to run beside other threads: it holds no lock of the interpreter."""
    return _cached(function, nogil=True)


@intrinsic  # type: ignore[untyped-decorator]
def uncounted(typing: Any, array: Any) -> Any:  # noqa: ARG001
    """In compiled code: the same array, whose owner is no longer counted by what is cut out of it.

    Each view of a counted array adds one to a counter and takes it off again, by locked instructions.
    Somebody else must hold the array meanwhile, as a caller from Python does.
    """
    from numba.core import cgutils  # only to compile: slow to import
    from numba.np.arrayobj import make_array

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:  # noqa: ARG001
        view = make_array(array)(context, builder, value=arguments[0])
        view.meminfo = cgutils.get_null_value(view.meminfo.type)
        view.parent = cgutils.get_null_value(view.parent.type)
        return view._getvalue()

    return array(array), generate


def depends_on(digest: str) -> None:
    """Keep functions compiled with another package's laws, named by a digest, apart from those without."""
    global _outside
    _outside = digest


def _cached(function: _F, **options: Any) -> Any:
    dispatcher = njit(**{"error_model": "numpy", **options})(function)
    dispatcher._cache = _Cache(function)
    return dispatcher


class _Cache(FunctionCache):  # type: ignore[misc]
    """numba's cache, good for what the function's sources are now."""

    def __init__(self, function: Callable[..., object]) -> None:
        super().__init__(function)
        self._source = function.__module__, Path(function.__code__.co_filename)
        self._function = function.__qualname__
        self._stamped = False

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """A function from the cache; None if it has to be compiled, for which numba makes itself ready.

        numba makes itself ready in any case and imports all that it can compile, for half a second. What is
        loaded needs the allocator only, and the salt of Python's hashes if it hashes: nothing here does.
        """
        rtsys.initialize(target_context)
        self._stamp()
        with self._guard_against_spurious_io_errors():
            found = self._load_overload(sig, target_context)
            if found is None:
                logger.info("compiling %s.%s: the first time takes a while", self._source[0], self._function)
            return found

    def save_overload(self, sig: Any, data: Any) -> None:
        """Put a function into the cache."""
        self._stamp()
        super().save_overload(sig, data)

    def _stamp(self) -> None:
        """Late: most processes use few of the functions that they import."""
        if not self._stamped:
            stamp = source_stamp(*self._source)
            if _outside:
                name = f"{self._impl.filename_base}-{_outside}"
                self._cache_file = IndexDataCacheFile(self._cache_path, name, stamp)
            self._cache_file._source_stamp = stamp
            self._stamped = True


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
    project = file.parents[module.count(".") + (file.name == "__init__.py")]
    found = []
    if _FINDS_SIBLINGS in _content(file):
        package = module.rpartition(".")[0]
        found += [(f"{package}.{path.stem}", path) for path in sorted(file.parent.glob("*.py"))]
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
    """What each import may mean: a module in a package, or else something that the package itself holds.

    A pattern finds them in a tenth of the time that a syntax tree takes; at worst it takes a line of a
    docstring for one more.
    """
    for package, several, one, modules in _IMPORT.findall(source):
        for name in _names(modules):
            yield (name,)
        for name in _names(several or one):
            yield f"{package}.{name}", package


def _names(listed: str) -> Iterator[str]:
    for part in _COMMENT.sub("", listed).split(","):
        words = part.split()  # `name as another`
        if words:
            yield words[0]
