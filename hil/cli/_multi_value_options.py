"""Options that take several values: `--holdout a b` is `--holdout a --holdout b`."""

from __future__ import annotations

from collections.abc import Iterable, Iterator


def each_with_its_option(arguments: Iterable[str], several: Iterable[str]) -> Iterator[str]:
    """The arguments with an option of `several` before each of its values, which end at the next option."""
    names = tuple(several)
    option, first, plain = "", False, False
    for argument in arguments:
        if plain or argument == "--":
            plain, option = True, ""
        elif argument in names:
            option, first = argument, True
            yield option
            continue
        elif argument.startswith("-") and argument != "-":
            option = ""
        elif option and first:
            first = False
        elif option:
            yield option
        yield argument
