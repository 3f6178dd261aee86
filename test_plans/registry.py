"""Classes by name: the package's own, and those that other packages offer by entry point."""

from __future__ import annotations

from collections.abc import Iterable
from importlib import metadata
from typing import Generic, TypeVar

from hil.core.errors import BadInputError
from hil.core.errors.wording import did_you_mean

T = TypeVar("T")


class Registry(Generic[T]):
    """Classes derived from `base`, by the name that a plan uses for them.

    An entry point of `group` adds a class under the entry point's name. The package's own names cannot
    be taken over. A class of another package is imported when it is asked for, not before.
    """

    def __init__(self, what: str, group: str, base: type[T], own: Iterable[tuple[str, type[T]]]) -> None:
        self._what = what
        self._group = group
        self._base = base
        self._own = dict(own)

    def names(self) -> tuple[str, ...]:
        """All names, the package's own first."""
        others = {point.name for point in metadata.entry_points(group=self._group)}
        return (*self._own, *sorted(others - set(self._own)))

    def find(self, name: str) -> type[T] | None:
        """The class called `name`, or None.

        Raises:
            BadInputError: an entry point of that name exists, but what it names cannot be used.
        """
        if name in self._own:
            return self._own[name]
        for point in metadata.entry_points(group=self._group, name=name):
            return self._load(point)
        return None

    def suggestion(self, name: str) -> str:
        """What to do about an unknown name."""
        return did_you_mean(name, self.names())

    def _load(self, point: metadata.EntryPoint) -> type[T]:
        where = f"entry point '{point.name}' of {self._group} ({point.value})"
        try:
            loaded = point.load()
        except Exception as error:  # another package's import may fail in any way
            raise BadInputError(
                f"cannot be loaded: {type(error).__name__}: {error}",
                where=where,
                fix="repair or uninstall the package that offers it",
            ) from error
        if not (isinstance(loaded, type) and issubclass(loaded, self._base)):
            raise BadInputError(
                f"is no {self._what}: a class derived from {self._base.__name__} is needed", where=where
            )
        return loaded
