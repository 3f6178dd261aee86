"""All that is wrong with a plan, reported at once."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Iterator

from hil.core.errors import BadInputError
from hil.core.errors.wording import listed


class PlanError(BadInputError):
    """Several mistakes of one plan; each is an error of its own, with its place."""

    def __init__(self, what: str, *, where: str = "", fix: str = "", found: tuple[BadInputError, ...] = ()):
        super().__init__(what, where=where, fix=fix)
        self.found = found


def plan_error(mistakes: Iterable[BadInputError]) -> BadInputError:
    """One error of all mistakes; the mistake itself if there is one only."""
    found = tuple({str(one): one for error in mistakes for one in getattr(error, "found", (error,))}.values())
    if len(found) == 1:
        return found[0]
    file = found[0].where.partition(": line ")[0]
    lines = listed([_on_a_line(one, file) for one in found])
    return PlanError(f"{len(found)} mistakes{lines}", where=file, found=found)


class PlanMistakes:
    """Mistakes that are collected while the rest of the plan is still looked at."""

    def __init__(self) -> None:
        self._found: list[BadInputError] = []

    def __bool__(self) -> bool:
        return bool(self._found)

    @contextlib.contextmanager
    def collected(self) -> Iterator[None]:
        """Collect what is refused in the block, and go on behind it."""
        try:
            yield
        except BadInputError as error:
            self._found.append(error)

    def refuse(self) -> None:
        """Raise what was found, if anything.

        Raises:
            BadInputError: the only mistake, or all of them.
        """
        if self._found:
            raise plan_error(self._found)


def _on_a_line(mistake: BadInputError, file: str) -> str:
    place = mistake.where.removeprefix(f"{file}: ")
    text = f"{mistake.what}; {mistake.fix}" if mistake.fix else mistake.what
    return f"{place}: {text}"
